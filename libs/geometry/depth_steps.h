#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"

namespace vismap {

/// The difference between the inverse depths of neighbours above which there is a depth jump
/// between them, in standard deviations.
///
/// It is `jump_sigmas` for a sensor that is as good as its noise model. Surfaces of a worse sensor,
/// or of one with coarser depth steps, would fall apart with that, so that the limit adapts to the
/// image: 1.3 times the bend that a tenth of the pixels exceed, at most 2.5 times `jump_sigmas`.
/// (True depth jumps are far fewer than a tenth.) The bend is the second difference of the inverse
/// depths of neighbours in a row. `w`, `sigma`: inverse depth and its standard deviation [1/m], 0 =
/// no depth. Samples every 12th pixel; with fewer than 500 samples the result is `jump_sigmas`.
double JumpSigmas(const Image<float>& w, const Image<float>& sigma, double jump_sigmas);

/// How noisy a depth image is, with holes or without: the bend that a tenth of the samples exceed,
/// in standard deviations of the noise model. A sample is four pixels with depth in a row, each the
/// first one that is at least 2 and at most 5 pixels after the one before; its bend is the smaller
/// of the two second differences of its inverse depths, scaled as if all distances were 1 pixel.
/// Rows are 16 pixels apart on average, at all distances from a multiple of 16, so that regular
/// holes do not hide all of them. 0 with fewer than 100 samples. Sensors that are as good as their
/// noise model have 1.6 to 1.9.
double BendAcrossHoles(const Image<float>& depth, const DepthNoiseModel& noise);

}  // namespace vismap
