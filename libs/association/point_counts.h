#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "association/associate.h"

namespace vismap {

/// The labels with votes at a voxel, strongest first, then kNone. Votes of merged labels are
/// summed; ties go to the lower label.
using Choices = std::array<SegmentLabel, kVoteSlots>;

/// Number of sampled points of a segment on voxels with these choices.
struct ChoiceCount {
  int32_t segment = -1;
  Choices choices{};
  int64_t points = 0;

  bool SameKey(const ChoiceCount& other) const {
    return segment == other.segment && choices == other.choices;
  }
  friend bool operator<(const ChoiceCount& a, const ChoiceCount& b) {
    return a.segment != b.segment ? a.segment < b.segment : a.choices < b.choices;
  }
};

/// All points of a frame, counted.
struct FrameCounts {
  std::vector<ChoiceCount> choices;  ///< each key once, ascending
  std::vector<int64_t> points;       ///< per segment: sampled points in range
};

/// Looks up the voxel of every sampled pixel with depth in range and a segment, once.
FrameCounts CountPoints(const SegmentedFrame& frame, const MapView& map,
                        const AssociationOptions& options);

}  // namespace vismap
