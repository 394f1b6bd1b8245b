#pragma once

#include <cstddef>
#include <cstdint>

#include "map/label_table.h"

namespace vismap {

/// Memory of the label table [bytes], about. Takes constant time.
size_t BytesOf(const LabelTable& labels);
/// Memory of the poses and times of so many frames [bytes], about.
size_t TrajectoryBytes(int64_t frames);
/// Memory that voxels of deleted blocks have left free in this process, for new blocks [bytes].
size_t SpareVoxelBytes();

}  // namespace vismap
