#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// What is wanted in the place of an object.
enum class ObjectAction : uint8_t {
  kLeaveOut,     ///< free space, as if it were taken away
  kMakeUnknown,  ///< unknown space
  kInflate,      ///< a larger object, for example to keep a distance from it
};

/// A change of the space that some objects take.
struct ObjectEdit {
  std::vector<SegmentLabel> labels;  ///< of the objects, alive or merged
  std::vector<BlockIndex> blocks;    ///< where they have votes; some more and repetitions are fine
  ObjectAction action = ObjectAction::kLeaveOut;
  double inflate_m = 0;  ///< for kInflate: by how much [m]
};

/// The largest inflation of an object [voxels].
inline constexpr int kMostInflatedVoxels = 28;

/// Space that differs from the plain classification.
struct EditedSpace {
  OccupancyDelta delta;  ///< the blocks that differ
  // Voxels whose state differs:
  int64_t freed = 0, made_unknown = 0, made_occupied = 0;
};

/// The occupancy of a map when objects are left out, are unknown, or are larger. See
/// libs/METHOD.md, Objects left out. Edits apply in the order kLeaveOut, kMakeUnknown, kInflate.
/// Takes time in proportion to the surface of the objects. Fails on an inflation that is not
/// finite, negative or more than kMostInflatedVoxels.
///
/// What becomes free: the voxels near or behind a surface that votes for the objects, and unseen
/// space that they and their supports enclose. What other labels occupy stays. A support stays as
/// it was seen; where the object hid it, and where it touches something else, space is unknown.
Result<EditedSpace> EditObjects(const SemanticMap& map, std::span<const ObjectEdit> edits,
                                const OccupancyOptions& options);

}  // namespace vismap
