#pragma once

#include <span>
#include <vector>

#include "map/label_table.h"

namespace vismap {

/// One instance that turned out to be two things.
struct InstanceSplit {
  InstanceId from{};  ///< which the side with more evidence keeps
  InstanceId to{};    ///< of the other side
  friend bool operator==(const InstanceSplit&, const InstanceSplit&) = default;
};

/// Takes note of the masks of a frame, and splits every instance of which these masks show two
/// labels apart whose bond (see MaskBonds) has come down to -`split_frames`; 0 = never. Its other
/// labels go to that one of the two that they are bound to more; those bound to neither stay with
/// the id. The side that leaves gets an instance that masks have given to it alone already, or else
/// a new one, and takes its evidence along. What one bad mask, or many, glued together comes apart
/// so, without regard to how long it was thought to be one.
std::vector<InstanceSplit> SplitInstances(std::span<const MaskedLabel> seen, double split_frames,
                                          LabelTable* labels);

}  // namespace vismap
