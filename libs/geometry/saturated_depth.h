#pragma once

#include <cstdint>

#include "geometry/frame.h"
#include "geometry/surface_options.h"

namespace vismap {

/// How much of the depth of frames is no measurement.
struct DepthLosses {
  int64_t frames = 0;
  int64_t pixels = 0;      ///< of all frames
  int64_t too_near = 0;    ///< pixels with depth nearer than SurfaceOptions::min_depth_m
  int64_t too_far = 0;     ///< pixels with depth farther than SurfaceOptions::max_depth_m
  int64_t saturated = 0;   ///< pixels with a value that the camera gives where it measured nothing
  double saturated_m = 0;  ///< the value that most of these had in the latest such frame [m]

  void Add(const DepthLosses& other);
};

/// Finds the readings of a frame that are no measurement, and counts them. Those outside of the
/// limits of depth are only counted, since PrepareDepth takes them out. Saturated ones become no
/// return: many cameras give one fixed value, mostly their largest, for glass and for what is out
/// of their range, and rays to it would make the solids before it free.
///
/// A value is saturated when the pixels that have exactly this value do not continue into their
/// surroundings: at most a fifth of the pixels beside them are as deep, within the sensor's noise
/// and its depth steps. That holds for values beyond 5 m, of which hardly any surface is mapped,
/// from a few pixels on. A nearer one must be the largest of its frame, of at least a two-hundredth
/// of the pixels, with next to nothing just before it, and the rest of the image must be noisy, as
/// then no real surface can be so smooth. In images without noise, as computed ones are, a far
/// value must be a whole number of metres. See libs/METHOD.md, Limits of depth.
///
/// Must see the depth before it is rectified, which changes equal values. Does not change anything
/// unless options.drop_saturated is set.
DepthLosses DropSaturatedDepth(const SurfaceOptions& options, SensorFrame* frame);

}  // namespace vismap
