#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "association/associate.h"
#include "map/label_table.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// What a segment of a frame was found to be in a map.
struct SeenSegment {
  SegmentLabel label = SegmentLabel::kNone;
  int32_t pixels = 0;
};

/// All segments of a frame, by SegmentIndex.
std::vector<SeenSegment> SeenIn(const SegmentedFrame& frame, const FrameAssociation& association);

/// What the frames of a map show of it, by the revision that each gave it.
using SeenByFrame = std::map<int64_t, std::vector<SeenSegment>>;

/// A map of which objects are compared with those of another one of the same frames.
struct SeenMap {
  const SeenByFrame& seen;
  const LabelTable& labels;
  std::set<InstanceId> objects{};  ///< that count
};

/// Which objects of two maps are the same, by the surface that the same frames show of both: the
/// same pixels of the same frames. It holds however far the surface has moved.
struct ObjectLinks {
  /// Objects before, each with the one that more than half of its pixels belong to after.
  std::map<InstanceId, InstanceId> became;
  /// Objects after that are more than half of two or more objects before, with these.
  std::map<InstanceId, std::vector<InstanceId>> joined;
  /// Objects before that are more than half of two or more objects after, with these.
  std::map<InstanceId, std::vector<InstanceId>> split;
  std::vector<InstanceId> gone;  ///< objects before that became none
  std::vector<InstanceId> came;  ///< objects after that none became, and none was split into
};

/// Only objects that a frame of both shows are compared. All lists are ascending.
ObjectLinks LinkObjects(const SeenMap& before, const SeenMap& after);

/// For people, without the end of a sentence: how many are the same, and the first ones of those
/// that are not.
std::string Sentence(const ObjectLinks& links);
/// {"became": [[1, 2], ...], "joined": [[[1, 3], 2], ...], "split": [[4, [4, 5]], ...],
/// "gone": [...], "came": [...]}: before, after.
std::string LinksJson(const ObjectLinks& links);

}  // namespace vismap
