#pragma once

#include <cstdint>
#include <vector>

#include "mapping/integrate.h"

namespace vismap {

/// A frame prepared for fusing blocks: images, projection, and what the options mean in the units
/// of voxels.
class FrameProjection {
 public:
  /// `labels`: the persistent label of each of the frame's segments.
  FrameProjection(const SegmentedFrame& frame, std::vector<SegmentLabel> labels,
                  const IntegrationOptions& options, const VoxelGridOptions& grid);

  /// What a frame did to one block.
  struct Outcome {
    bool changed = false;
    int64_t voxels_updated = 0;
    int64_t votes_evicted = 0;
  };

  /// Projects the voxels of the block at `index` into the frame and updates `block`, which may turn
  /// from unseen to seen empty to surface. `wholly_free` skips the projection: every voxel was seen
  /// empty.
  Outcome Fuse(BlockIndex index, bool wholly_free, Block& block) const;

 private:
  struct Samples;
  void Sample(BlockIndex index, Samples& samples) const;
  void SampleVoxel(float x, float y, float z, int voxel, Samples& samples) const;
  Outcome FuseSurface(const Samples& samples, SurfaceVoxels& voxels) const;
  void FuseVoxel(const Samples& samples, size_t i, SurfaceVoxels& voxels) const;

  const SegmentedFrame& frame_;
  std::vector<SegmentLabel> labels_;
  Eigen::Matrix3d R_C_W_;
  Eigen::Vector3d t_C_W_;
  Image<float> ray_length_;  // length of the ray through a pixel per metre of depth
  double voxel_size_;
  float truncation_, min_range_, max_range_, free_space_range_, max_weight_, vote_distance_,
      drop_off_start_;
  bool free_space_;
};

}  // namespace vismap
