#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mapping/depth_pyramid.h"
#include "mapping/integrate.h"
#include "mapping/mask_cuts.h"
#include "mapping/visible_blocks.h"
#include "mapping/voxel_kernels.h"

namespace vismap {

/// A frame prepared for fusing blocks: images, projection, and what the options mean in the units
/// of voxels.
class FrameProjection {
 public:
  /// What stands for the segments of the frame in the map.
  struct Labels {
    std::vector<SegmentLabel> of_segment;
    const MaskCuts& cuts;
    const LabelTable& table;
  };
  /// `pyramid`: of the frame's depth. All must outlive this.
  FrameProjection(const SegmentedFrame& frame, const DepthPyramid& pyramid, Labels labels,
                  const IntegrationOptions& options, const VoxelGridOptions& grid);

  /// What a frame did to one block.
  struct Outcome {
    NeighbourBits affected = 0;  ///< see MapDelta
    int64_t voxels_updated = 0;
    int64_t votes_evicted = 0;
    std::map<SegmentLabel, uint32_t> cleared = {};  ///< see MapDelta

    bool changed() const { return affected != 0; }
  };

  /// Projects the voxels of the block at `index` into the frame and updates `block`, which may turn
  /// from unseen to seen empty to surface. `wholly_free` skips the projection: every voxel was seen
  /// empty.
  Outcome Fuse(BlockIndex index, BlockVisibility view, Block& block) const;

 private:
  Outcome FuseSurface(const ProjectedVoxels& projected, VoxelSamples& samples,
                      SurfaceVoxels& voxels) const;
  VoxelBits CarveWhatIsPassed(const ProjectedVoxels& projected, VoxelSamples& samples,
                              SurfaceVoxels& voxels) const;
  void BlendColors(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                   const VoxelArray<float>& shares, SurfaceVoxels& voxels) const;
  int64_t Vote(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
               SurfaceVoxels& voxels) const;
  bool HasKeptLabels(const SurfaceVoxels& voxels) const;
  bool IsHeldByKept(const SurfaceVoxels& voxels, size_t voxel) const;
  void TakeVotesFrom(SegmentLabel label, SurfaceVoxels& voxels, size_t voxel) const;

  const SegmentedFrame& frame_;
  Labels labels_;
  int cut_votes_;
  Eigen::Matrix3d R_C_W_;
  Eigen::Vector3d t_C_W_;
  double voxel_size_;
  MeasurementLimits limits_;
  WeightLimits weights_;
  CarvingLimits carving_;
  Image<float> clear_depth_;  // empty without carving
};

}  // namespace vismap
