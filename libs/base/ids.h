#pragma once

#include <compare>
#include <cstdint>
#include <type_traits>

namespace vismap {

/// Persistent id of a surface piece in the map (the paper's l). 0 = none; never reused within a
/// map.
enum class SegmentLabel : uint32_t { kNone = 0 };

/// Persistent id of one object in the map, a set of segment labels (the paper's o_m). 0 = none;
/// never reused.
enum class InstanceId : uint32_t { kNone = 0 };

/// Semantic category, by default the official COCO category id. 0 = unknown.
enum class ClassId : uint16_t { kUnknown = 0 };

/// Connected region of one depth image, 0..n-1; dies with the frame.
enum class SegmentIndex : int32_t { kNone = -1 };

/// Index of a 2-D detection in its frame's DetectionSet, 0..n-1.
enum class DetectionIndex : int32_t { kNone = -1 };

/// Which camera a frame came from. Any number of cameras may feed one map.
enum class CameraId : int32_t {};

/// The integer behind an id: for printing, encoding and indexing, never for arithmetic between ids.
template <typename Id>
constexpr std::underlying_type_t<Id> Raw(Id id) {
  return static_cast<std::underlying_type_t<Id>>(id);
}

}  // namespace vismap
