#pragma once

#include <cstddef>
#include <cstdint>

#include "base/ids.h"

namespace vismap {

// Numbers of regions, segments and detections as indices of vectors. They must not be negative.

constexpr size_t At(int32_t number) { return static_cast<size_t>(number); }
constexpr size_t At(SegmentIndex segment) { return At(Raw(segment)); }
constexpr size_t At(DetectionIndex detection) { return At(Raw(detection)); }

}  // namespace vismap
