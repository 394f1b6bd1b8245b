#pragma once

#include "geometry/image.h"

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

}  // namespace vismap
