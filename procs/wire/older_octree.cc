#include "wire/older_octree.h"

#include <algorithm>
#include <iterator>

namespace vismap {
namespace {

/// Copies the fields that several kinds of messages have, those that this kind has.
template <typename Older, typename Current>
void CopyShared(const Older& older, Current* message) {
  message->utime = older.utime;
  message->seq = older.seq;
  message->source = older.source;
  message->map_id = older.map_id;
  if constexpr (requires { older.request_id; }) message->request_id = older.request_id;
  if constexpr (requires { older.revision; }) {
    message->revision = older.revision;
    message->encoding = older.encoding;
  }
  if constexpr (requires { older.bbx_min_W; }) {
    std::copy_n(older.bbx_min_W, std::size(older.bbx_min_W), message->bbx_min_W);
    std::copy_n(older.bbx_max_W, std::size(older.bbx_max_W), message->bbx_max_W);
    message->resolution_m = older.resolution_m;
    message->unknown = older.unknown;
  }
}

}  // namespace

octree_t ToCurrentVersion(const octree_v1_t& older) {
  octree_t message{};
  CopyShared(older, &message);
  message.frame_id = older.frame_id;
  message.tree_type = older.tree_type;
  message.voxel_size_m = older.voxel_size_m;
  message.occupied_max_voxels = older.occupied_max_voxels;
  message.free_min_voxels = older.free_min_voxels;
  message.min_observations = older.min_observations;
  message.n_nodes = older.n_nodes;
  message.data_size = older.data_size;
  message.data = older.data;
  return message;
}

map_request_t ToCurrentVersion(const map_request_v1_t& older) {
  map_request_t message{};
  CopyShared(older, &message);
  message.verb = older.verb;
  message.argument = older.argument;
  message.path = older.path;
  message.has_bbx = older.has_bbx;
  return message;
}

map_reply_t ToCurrentVersion(const map_reply_v1_t& older) {
  map_reply_t message{};
  CopyShared(older, &message);
  message.requester = older.requester;
  message.ok = older.ok;
  message.message = older.message;
  message.payload_size = older.payload_size;
  message.payload = older.payload;
  return message;
}

}  // namespace vismap
