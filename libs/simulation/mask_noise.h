#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "geometry/image.h"
#include "segmentation/detections.h"

namespace vismap {

/// Errors of a detector's masks. All are >= 0.
struct MaskNoise {
  int max_growth = 2;  ///< grown or shrunk by up to so many pixels
  int max_shift = 0;   ///< moved by up to so many pixels along u and v
  /// Standard deviation of the border's displacement [px], inwards or outwards. It varies over
  /// lengths of four times this value. 2.3 % of the mask become holes of that size.
  double waver = 0;
};

/// The mask of object `id` with errors, in the smallest box around its pixels; empty if no pixel is
/// left. `ids` is the HxW image of object ids, and `box` contains all pixels of the object. The
/// errors are a function of `key`.
Mask NoisyMask(const Image<uint16_t>& ids, uint16_t id, const Eigen::AlignedBox2i& box,
               const MaskNoise& noise, uint64_t key);

}  // namespace vismap
