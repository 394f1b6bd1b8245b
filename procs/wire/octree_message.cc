#include "wire/octree_message.h"

#include <cmath>

namespace vismap {
namespace {

constexpr double kMaxLength = 1000;       // [m]
constexpr double kMaxObservations = 1e9;  // far beyond any map, and within an int

}  // namespace

octree_t Encode(const OctreeMessage& octree) {
  octree_t message{};
  message.utime = octree.utime;
  message.published_utime = octree.published_utime;
  message.map_id = octree.map_id;
  message.revision = octree.revision;
  message.frame_id = "W";
  message.tree_type = "OcTree";
  message.encoding = octree_t::ENCODING_BT;
  message.unknown = octree.octree.unknown == UnknownPolicy::kOccupied ? octree_t::UNKNOWN_OCCUPIED
                                                                      : octree_t::UNKNOWN_ABSENT;
  message.resolution_m = octree.octree.resolution;
  message.voxel_size_m = octree.voxel_size;
  for (int axis = 0; axis < 3; ++axis) {
    const bool empty = octree.octree.bounds_W.isEmpty();
    message.bbx_min_W[axis] = empty ? 0 : octree.octree.bounds_W.min()[axis];
    message.bbx_max_W[axis] = empty ? 0 : octree.octree.bounds_W.max()[axis];
  }
  message.shell_m = octree.octree.shell_m;
  message.inflated_by_m = octree.inflated_by;
  message.n_assumed_free = static_cast<int32_t>(octree.assumed_free.size());
  for (const VoxelIndex& leaf : octree.assumed_free) {
    message.assumed_free_x.push_back(leaf.x);
    message.assumed_free_y.push_back(leaf.y);
    message.assumed_free_z.push_back(leaf.z);
  }
  message.occupied_max_voxels = octree.rule.occupied_max_voxels;
  message.free_min_voxels = octree.rule.free_min_voxels;
  message.min_observations = octree.rule.min_observations;
  message.n_nodes = octree.octree.nodes;
  message.data = octree.octree.bytes;
  message.data_size = static_cast<int32_t>(message.data.size());
  return message;
}

Result<OctreeMessage> Decode(const octree_t& message) {
  const std::string where = "octree_t of map '" + message.map_id + "', revision " +
                            std::to_string(message.revision) + ": ";
  if (message.encoding != octree_t::ENCODING_BT) {
    return Fail(where + "the encoding is " + std::to_string(message.encoding) +
                ", expected 0 (.bt)");
  }
  if (message.unknown != octree_t::UNKNOWN_ABSENT &&
      message.unknown != octree_t::UNKNOWN_OCCUPIED) {
    return Fail(where + "the policy for unknown space is " + std::to_string(message.unknown) +
                ", expected 0 or 1");
  }
  if (!(message.min_observations >= 0 && message.min_observations <= kMaxObservations)) {
    return Fail(where + "min_observations is outside [0, 1000000000]");
  }
  for (const double length : {message.shell_m, message.inflated_by_m}) {
    if (!(length >= 0 && length <= kMaxLength))
      return Fail(where + "shell_m or inflated_by_m is outside [0, 1000]");
  }
  const Result<OctreeStreamInfo> octree = CheckOctree(message.data, where + "data");
  if (!octree) return tl::unexpected(octree.error());
  if (!(std::abs(octree->resolution - message.resolution_m) < 1e-6)) {
    return Fail(where + "resolution_m is " + std::to_string(message.resolution_m) +
                ", but the stream has " + std::to_string(octree->resolution));
  }
  if (octree->nodes != message.n_nodes) {
    return Fail(where + "n_nodes is " + std::to_string(message.n_nodes) + ", but the stream has " +
                std::to_string(octree->nodes));
  }
  OctreeMessage value;
  value.utime = message.utime;
  value.published_utime = message.published_utime;
  value.map_id = message.map_id;
  value.revision = message.revision;
  value.voxel_size = message.voxel_size_m;
  value.rule.occupied_max_voxels = message.occupied_max_voxels;
  value.rule.free_min_voxels = message.free_min_voxels;
  value.rule.min_observations = static_cast<int>(message.min_observations);
  value.octree.bytes = message.data;
  value.octree.shell_m = message.shell_m;
  value.inflated_by = message.inflated_by_m;
  for (size_t i = 0; i < message.assumed_free_x.size(); ++i) {
    value.assumed_free.push_back(
        {message.assumed_free_x[i], message.assumed_free_y[i], message.assumed_free_z[i]});
  }
  value.octree.resolution = message.resolution_m;
  value.octree.nodes = message.n_nodes;
  value.octree.unknown = message.unknown == octree_t::UNKNOWN_OCCUPIED ? UnknownPolicy::kOccupied
                                                                       : UnknownPolicy::kAbsent;
  value.octree.bounds_W =
      Eigen::AlignedBox3d(Eigen::Vector3d(message.bbx_min_W), Eigen::Vector3d(message.bbx_max_W));
  return value;
}

}  // namespace vismap
