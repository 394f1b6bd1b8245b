#pragma once

#include <cstddef>
#include <cstdint>

#include "map/label_table.h"

namespace vismap {

/// Memory of what is known of the labels, and of the trajectory of so many frames [bytes], about;
/// take constant time.
size_t BytesOf(const LabelTable& labels);
size_t TrajectoryBytes(int64_t frames);
/// Memory that voxels of all maps of this process have left, for the next ones [bytes].
size_t SpareVoxelBytes();

}  // namespace vismap
