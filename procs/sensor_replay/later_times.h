#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "datasets/dataset.h"
#include "wire/frame_key.h"

namespace vismap {

/// By how much the utimes of a sequence without a clock must be moved so that its frames are not
/// taken for those that a map has already [us]. `in_map` are the frames of the map with their poses
/// (PoseDigest). When the map has frames of this very sequence, they get the same times again; else
/// the sequence goes on after the newest frame of its camera. 0 = nothing must be moved.
int64_t LaterTimes(const Dataset& dataset, const std::map<FrameKey, std::string>& in_map);

}  // namespace vismap
