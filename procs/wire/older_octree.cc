#include "wire/older_octree.h"

#include <algorithm>
#include <iterator>

namespace vismap {
namespace {

/// Copies the box.
template <typename Older, typename Current>
void CopyBox(const Older& older, Current* message) {
  std::copy(std::begin(older.bbx_min_W), std::end(older.bbx_min_W), std::begin(message->bbx_min_W));
  std::copy(std::begin(older.bbx_max_W), std::end(older.bbx_max_W), std::begin(message->bbx_max_W));
}

}  // namespace

octree_t ToCurrentVersion(const octree_v1_t& older) {
  octree_t message{};
  message.utime = older.utime;
  message.seq = older.seq;
  message.source = older.source;
  message.map_id = older.map_id;
  message.revision = older.revision;
  message.frame_id = older.frame_id;
  message.tree_type = older.tree_type;
  message.encoding = older.encoding;
  message.unknown = older.unknown;
  message.resolution_m = older.resolution_m;
  message.voxel_size_m = older.voxel_size_m;
  CopyBox(older, &message);
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
  message.utime = older.utime;
  message.seq = older.seq;
  message.source = older.source;
  message.request_id = older.request_id;
  message.map_id = older.map_id;
  message.verb = older.verb;
  message.argument = older.argument;
  message.path = older.path;
  message.has_bbx = older.has_bbx;
  CopyBox(older, &message);
  message.resolution_m = older.resolution_m;
  message.unknown = older.unknown;
  return message;
}

map_reply_t ToCurrentVersion(const map_reply_v1_t& older) {
  map_reply_t message{};
  message.utime = older.utime;
  message.seq = older.seq;
  message.source = older.source;
  message.requester = older.requester;
  message.request_id = older.request_id;
  message.ok = older.ok;
  message.message = older.message;
  message.map_id = older.map_id;
  message.revision = older.revision;
  message.encoding = older.encoding;
  message.payload_size = older.payload_size;
  message.payload = older.payload;
  return message;
}

}  // namespace vismap
