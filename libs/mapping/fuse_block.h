#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "mapping/depth_pyramid.h"
#include "mapping/integrate.h"
#include "mapping/mask_cuts.h"
#include "mapping/thin_hits.h"
#include "mapping/visible_blocks.h"
#include "mapping/voxel_kernels.h"

namespace vismap {

/// A frame prepared for fusing it into blocks: its images, its projection, and the options in the
/// units in which voxels are stored.
class FrameProjection {
 public:
  /// The map's labels, as far as votes need them.
  struct Labels {
    std::vector<SegmentLabel> of_segment;  ///< kNone = the segment has no label
    const MaskCuts& cuts;
    const LabelTable& table;
  };
  /// `depth`: the frame's depth with less noise, see SmoothDepth; `pyramid`: of `depth`. The frame
  /// and what the other arguments refer to must outlive this object.
  FrameProjection(const SegmentedFrame& frame, const Image<float>& depth,
                  const DepthPyramid& pyramid, Labels labels, const IntegrationOptions& options,
                  const VoxelGridOptions& grid);

  /// What the frame changed in one block; the members mean what those of MapDelta do.
  struct Outcome {
    NeighbourBits affected = 0;
    int64_t voxels_updated = 0;
    int64_t votes_evicted = 0;
    std::map<SegmentLabel, uint32_t> cleared = {};

    bool changed() const { return affected != 0; }
  };

  /// Projects the voxels of the block at `index` into the frame and updates `block`, which may
  /// change from unseen to free space, and from either to surface. Voxels of a block without
  /// surface are not projected when `view` is kWhollyFree: the frame saw all of them empty.
  Outcome Fuse(BlockIndex index, BlockVisibility view, Block& block) const;

 private:
  VoxelLattice LatticeOf(BlockIndex index) const;
  Outcome FuseVoxels(BlockIndex index, BlockVisibility view, Block& block) const;
  VoxelBits CountThin(BlockIndex index, Block& block) const;
  std::span<const ThinHit> ThinHitsIn(BlockIndex index) const;
  Outcome FuseSurface(const ProjectedVoxels& projected, VoxelSamples& samples,
                      SurfaceVoxels& voxels) const;
  VoxelBits CarvePassedVoxels(const ProjectedVoxels& projected, VoxelSamples& samples,
                              SurfaceVoxels& voxels) const;
  void BlendColors(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
                   const VoxelArray<float>& shares, SurfaceVoxels& voxels) const;
  int64_t Vote(const VoxelSamples& samples, const VoxelArray<int32_t>& pixel,
               SurfaceVoxels& voxels) const;
  bool HasKeptLabels(const SurfaceVoxels& voxels) const;
  bool IsHeldByKept(const SurfaceVoxels& voxels, size_t voxel) const;
  void RemoveVotes(SegmentLabel label, SurfaceVoxels& voxels, size_t voxel) const;

  const SegmentedFrame& frame_;
  const Image<float>& depth_;
  Labels labels_;
  int cut_votes_;
  Eigen::Matrix3d R_C_W_;
  Eigen::Vector3d t_C_W_;
  double voxel_size_;
  MeasurementLimits limits_;
  WeightLimits weights_;
  CarvingLimits carving_;
  Image<float> clear_depth_;  // see ClearDepth; empty without carving
  bool keep_thin_;
  std::vector<ThinHit> thin_hits_;  // of the frame
};

}  // namespace vismap
