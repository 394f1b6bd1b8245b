#include "client/tree_checks.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "wire/octree_message.h"

namespace vismap {

std::string ChannelOf(TreeKind kind) {
  switch (kind) {
    case TreeKind::kClosed:
      return "OCTOMAP";
    case TreeKind::kInflated:
      return "OCTOMAP_INFLATED";
    case TreeKind::kCoarse:
      return "OCTOMAP_COARSE";
    case TreeKind::kRaw:
      return "OCTOMAP_RAW";
  }
  throw std::invalid_argument("this kind of tree does not exist: " +
                              std::to_string(static_cast<int>(kind)));
}

std::string ProblemOf(TreeKind kind, const octree_t& tree) {
  const auto decoded = Decode(tree);
  if (!decoded) return decoded.error().message;
  if (tree.n_nodes == 0) return "an empty tree has come on " + ChannelOf(kind);
  if (kind != TreeKind::kRaw && tree.unknown != octree_t::UNKNOWN_OCCUPIED) {
    return "the tree on " + ChannelOf(kind) +
           " is raw, and planners would take unknown space for free; set octomap_exporter.unknown "
           "to OCCUPIED";
  }
  return "";
}

octree_t TreeOf(map_reply_t reply) {
  octree_t tree{};
  tree.utime = reply.data_utime;
  tree.source = reply.source;
  tree.published_utime = reply.utime;
  tree.map_id = reply.map_id;
  tree.revision = reply.revision;
  tree.frame_id = "W";
  tree.tree_type = "OcTree";
  tree.encoding = reply.encoding == "bt" ? octree_t::ENCODING_BT : octree_t::ENCODING_OT;
  tree.unknown = reply.unknown;
  tree.resolution_m = reply.resolution_m;
  std::copy(reply.bbx_min_W, reply.bbx_min_W + 3, tree.bbx_min_W);
  std::copy(reply.bbx_max_W, reply.bbx_max_W + 3, tree.bbx_max_W);
  tree.shell_m = reply.shell_m;
  tree.inflated_by_m = reply.inflated_by_m;
  const auto checked = CheckOctree(reply.payload, "the reply");
  tree.n_nodes = checked ? checked->nodes : 0;
  tree.data = std::move(reply.payload);
  tree.data_size = static_cast<int32_t>(tree.data.size());
  return tree;
}

bool OfOneState(const octree_t& a, const octree_t& b) {
  return a.map_id == b.map_id && a.revision == b.revision && a.data == b.data;
}

}  // namespace vismap
