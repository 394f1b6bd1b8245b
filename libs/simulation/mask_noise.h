#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "geometry/image.h"
#include "segmentation/detections.h"

namespace vismap {

/// Errors of a detector's masks.
struct MaskNoise {
  int max_growth = 2;  ///< grown or shrunk by up to so many pixels; >= 0
  int max_shift = 0;   ///< moved by up to so many pixels each way; >= 0
  /// Deviation of the rim [px]: it bites into the object here and bleeds onto the background there,
  /// over stretches of four times this. A fortieth of the mask is holes of that size. >= 0
  double waver = 0;
};

/// The pixels of object `id`, all of which lie in `box`, as a detector's mask: tight; empty when
/// nothing is left of it. `key` decides on the errors.
Mask NoisyMask(const Image<uint16_t>& ids, uint16_t id, const Eigen::AlignedBox2i& box,
               const MaskNoise& noise, uint64_t key);

}  // namespace vismap
