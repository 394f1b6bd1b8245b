#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include "association/associate.h"

namespace vismap {

/// The labels that a voxel votes for, strongest first; kNone pads.
using Choices = std::array<SegmentLabel, kVoteSlots>;

/// How many sampled points of a segment fell on voxels with these choices.
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

/// What the frame's points say.
struct FrameCounts {
  std::vector<ChoiceCount> choices;  ///< each key once, ascending
  std::vector<int64_t> points;       ///< per segment, sampled points in range
};

/// Looks up the voxel of every sampled pixel, once.
FrameCounts CountPoints(const SegmentedFrame& frame, const MapView& map,
                        const AssociationOptions& options);

}  // namespace vismap
