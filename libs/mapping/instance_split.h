#pragma once

#include <span>
#include <vector>

#include "map/label_table.h"

namespace vismap {

/// An instance that turned out to cover two objects.
struct InstanceSplit {
  InstanceId from{};  ///< stays with the labels that have more evidence for it
  InstanceId to{};    ///< the instance of the other labels from now on
  friend bool operator==(const InstanceSplit&, const InstanceSplit&) = default;
};

/// Updates the bonds of the table (see MaskBonds) with the labels under the masks of one frame,
/// then splits instances that cover two objects, mostly because an earlier mask covered both. Not
/// in the paper; see "Splitting instances" in libs/METHOD.md, Labels and instances.
///
/// An instance is split when two of its labels lie under different masks of this frame and their
/// bond is at most -`split_frames`; 0 = never. Each of its other labels joins the one of the two to
/// which it has the stronger bonds; labels without bonds to either keep the instance. It is also
/// split when no bond is that low, but the lowest bond of two of its labels is at most
/// -`split_frames` / 2, and the bonds between the two sides, divided from these two labels, sum to
/// -`split_frames` or less. This is needed since objects of several labels show another pair of
/// labels in each frame. The side with
/// less evidence for the instance leaves it and takes this evidence along: to the instance for
/// which its labels have most evidence among those that no label reads out as, else to a new one.
std::vector<InstanceSplit> SplitInstances(std::span<const MaskedLabel> seen, double split_frames,
                                          LabelTable* labels);

}  // namespace vismap
