#include "wire/octree_update.h"

#include "wire/delta_fields.h"

namespace vismap {

octree_delta_t Encode(const OctreeUpdate& update) {
  octree_delta_t message{};
  SetDeltaFields(update.leaves, &message);
  message.published_utime = update.published_utime;
  message.resolution_m = update.leaves.delta.voxel_size;
  message.voxel_size_m = update.voxel_size;
  message.shell_m = update.shell;
  return message;
}

Result<OctreeUpdate> Decode(const octree_delta_t& message) {
  constexpr double kMaxShell = 1000;
  if (!(message.shell_m >= 0 && message.shell_m <= kMaxShell))
    return Fail("octree_delta_t of map '" + message.map_id + "': shell_m is outside [0, 1000]");
  Result<MapUpdate> leaves = ReadDeltaFields(message, message.resolution_m);
  if (!leaves) return tl::unexpected(leaves.error());
  return OctreeUpdate{std::move(*leaves), message.published_utime, message.voxel_size_m,
                      message.shell_m};
}

}  // namespace vismap
