#pragma once

#include "geometry/image.h"

namespace vismap {

/// The difference of neighbours' inverse depths from which a depth image jumps, in standard
/// deviations: `jump_sigmas`, which the model of the sensor's noise asks for, or as much as the
/// image itself needs so that a sensor that is worse than its model, or measures in coarser steps,
/// does not fall to pieces: 1.3 times the bend that a tenth of the neighbours in a row exceed, at
/// most 2.5 times `jump_sigmas`. True jumps are far rarer than that. `w`, `sigma`: inverse depth
/// and its standard deviation [1/m], 0 = no return. Looks at a part of the pixels; images with
/// fewer than 500 such neighbours tell nothing.
double JumpSigmas(const Image<float>& w, const Image<float>& sigma, double jump_sigmas);

}  // namespace vismap
