#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "geometry/frame.h"
#include "geometry/noise_model.h"
#include "map/block.h"

namespace vismap {

/// A voxel in which a reading of something thin ended.
struct ThinHit {
  BlockIndex block;
  int32_t voxel = 0;  ///< its offset in the block
  friend auto operator<=>(const ThinHit&, const ThinHit&) = default;
};

/// What counts as thin, and where it is looked for.
struct ThinOptions {
  double voxel_size = 0.01;  ///< [m]
  double min_range = 0.1;    ///< [m along z]
  double max_range = 5.0;    ///< [m along z]
  DepthNoiseModel noise = KinectNoise();
};

/// The voxels in which readings of thin things end, each once, ascending. A thing is thin where it
/// is at most two voxels wide along a row or a column of the image, and what is seen on both sides
/// of it is at least two voxels, and four standard deviations of the depth, farther away. Readings
/// with a standard deviation above the size of a voxel are left out, since they do not tell the
/// voxel. `depth`: HxW [m], NaN = no return. The result does not depend on the number of threads.
std::vector<ThinHit> FindThinHits(const FrameHeader& header, const Image<float>& depth,
                                  const ThinOptions& options);

}  // namespace vismap
