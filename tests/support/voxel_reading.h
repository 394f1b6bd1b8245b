#pragma once

#include <optional>

#include "map/surface_reader.h"
#include "map/voxel_map.h"

namespace vismap::testing_support {

/// The TSDF at one voxel.
struct VoxelReading {
  float distance = 0;    ///< truncated signed distance [m], positive towards the camera
  float weight = 0;      ///< integration weight; 1 = one observation from 1 m
  int observations = 0;  ///< frames that saw the voxel, at most 255
};

/// The voxel at an offset of a block; nullopt when it is unseen. A voxel of a block of free space
/// reads as distance = truncation, with the number of observations that the block knows (1 or 2).
inline std::optional<VoxelReading> ReadVoxel(const VoxelMap& map, const Block& block, int offset) {
  const auto truncation = static_cast<float>(map.truncation());
  const auto free_reading = [&](int observations) {
    return VoxelReading{truncation, static_cast<float>(observations), observations};
  };
  if (block.surface) {
    SurfaceReader reader;
    const SurfaceVoxels& voxels = *reader.Read(block);
    const auto i = static_cast<size_t>(offset);
    if (voxels.weight[i] == 0) return std::nullopt;
    return VoxelReading{static_cast<float>(voxels.distance[i]) * truncation / kTruncationSteps,
                        static_cast<float>(voxels.weight[i]) / kWeightScale,
                        voxels.observations[i]};
  }
  if (block.all_free) return free_reading(2);
  if (block.free && block.free->SeenTwice(offset)) return free_reading(2);
  if (block.free && block.free->SeenOnce(offset)) return free_reading(1);
  return std::nullopt;
}

inline std::optional<VoxelReading> ReadVoxel(const VoxelMap& map, VoxelIndex voxel) {
  const Block* block = map.Find(BlockOf(voxel));
  if (block == nullptr) return std::nullopt;
  return ReadVoxel(map, *block, OffsetInBlock(voxel));
}

/// The voxel that contains a point [m].
inline VoxelIndex VoxelAt(const VoxelMap& map, const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d cell = (p_W / map.voxel_size()).array().floor();
  return {static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
          static_cast<int32_t>(cell.z())};
}

/// The centre of a voxel in W [m].
inline Eigen::Vector3d VoxelCenter(const VoxelMap& map, VoxelIndex voxel) {
  return (Eigen::Vector3d(voxel.x, voxel.y, voxel.z).array() + 0.5) * map.voxel_size();
}

}  // namespace vismap::testing_support
