#include "map/label_votes.h"

#include <algorithm>

namespace vismap {
namespace {

constexpr size_t kPaletteCapacity = 255;

// Drops palette entries that no slot uses any more.
void CompactPalette(SurfaceVoxels& voxels) {
  std::array<uint8_t, kPaletteCapacity + 1> used{};
  for (const auto& slots : voxels.slot_label) {
    for (const uint8_t entry : slots) used[entry] = 1;
  }
  std::array<uint8_t, kPaletteCapacity + 1> moved{};
  std::vector<SegmentLabel> palette;
  for (size_t entry = 1; entry <= voxels.palette.size(); ++entry) {
    if (!used[entry]) continue;
    palette.push_back(voxels.palette[entry - 1]);
    moved[entry] = static_cast<uint8_t>(palette.size());
  }
  for (auto& slots : voxels.slot_label) {
    for (uint8_t& entry : slots) entry = moved[entry];
  }
  voxels.palette = std::move(palette);
}

}  // namespace

uint8_t PaletteEntry(SurfaceVoxels& voxels, SegmentLabel label) {
  const auto find = [&] {
    return static_cast<size_t>(std::find(voxels.palette.begin(), voxels.palette.end(), label) -
                               voxels.palette.begin());
  };
  const size_t found = find();
  if (found < voxels.palette.size()) return static_cast<uint8_t>(found + 1);
  if (voxels.palette.size() == kPaletteCapacity) CompactPalette(voxels);
  if (voxels.palette.size() == kPaletteCapacity) return 0;
  voxels.palette.push_back(label);
  return static_cast<uint8_t>(voxels.palette.size());
}

bool AddVoteForEntry(SurfaceVoxels& voxels, int voxel, uint8_t entry) {
  if (entry == 0) return false;
  auto& labels = voxels.slot_label[static_cast<size_t>(voxel)];
  auto& votes = voxels.slot_votes[static_cast<size_t>(voxel)];
  for (size_t slot = 0; slot < kVoteSlots; ++slot) {
    if (labels[slot] != entry && labels[slot] != 0) continue;
    labels[slot] = entry;
    if (votes[slot] == 255) {
      for (uint8_t& count : votes) count = static_cast<uint8_t>(count / 2);
    }
    ++votes[slot];
    return true;
  }
  const auto weakest =
      static_cast<size_t>(std::min_element(votes.begin(), votes.end()) - votes.begin());
  if (votes[weakest] > 1) {
    --votes[weakest];
    return false;
  }
  labels[weakest] = entry;
  votes[weakest] = 1;
  return true;
}

}  // namespace vismap
