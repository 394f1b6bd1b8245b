#pragma once

#include <compare>
#include <cstdint>
#include <type_traits>

namespace vismap {

/// Persistent id of a piece of surface in the map (the paper's l). 0 = none; never used again
/// within a map.
enum class SegmentLabel : uint32_t { kNone = 0 };

/// Persistent id of an object in the map, a set of segment labels (the paper's o_m). 0 = none;
/// never used again within a map.
enum class InstanceId : uint32_t { kNone = 0 };

/// Semantic category, by default the official COCO category id. 0 = unknown.
enum class ClassId : uint16_t { kUnknown = 0 };

/// Index of a segment, a connected region of one depth image, 0..n-1; valid within its frame.
enum class SegmentIndex : int32_t { kNone = -1 };

/// Index of a 2-D detection in its frame's DetectionSet, 0..n-1.
enum class DetectionIndex : int32_t { kNone = -1 };

/// Id of the camera of a frame. Several cameras may feed one map.
enum class CameraId : int32_t {};

/// The integer behind an id, for printing, encoding and indexing.
template <typename Id>
constexpr std::underlying_type_t<Id> Raw(Id id) {
  return static_cast<std::underlying_type_t<Id>>(id);
}

}  // namespace vismap
