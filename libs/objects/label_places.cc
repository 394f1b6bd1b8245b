#include "objects/label_places.h"

#include "base/ids.h"

namespace vismap {
namespace {
// A palette grows at its end until it is full; only then are labels dropped from it.
constexpr size_t kFull = 255;
}  // namespace

void LabelPlaces::Clear() {
  known_.clear();
  places_.clear();
}

void LabelPlaces::AddBlocks(const VoxelMap& voxels, std::span<const BlockIndex> changed) {
  SurfaceReader reader;
  for (const BlockIndex& index : changed) {
    const Block* block = voxels.Find(index);
    if (block == nullptr) continue;
    if (const SurfaceVoxels* surface = reader.Read(*block)) AddBlock(index, surface->palette);
    reader.Trim();
  }
}

void LabelPlaces::AddBlock(BlockIndex index, const std::vector<SegmentLabel>& palette) {
  uint8_t& known = known_[index];
  const bool anew = palette.size() == kFull || palette.size() < known;
  for (size_t i = anew ? 0 : known; i < palette.size(); ++i) {
    const size_t label = Raw(palette[i]);
    if (places_.size() <= label) places_.resize(label + 1);
    places_[label].push_back(index);
  }
  known = static_cast<uint8_t>(palette.size());
}

void LabelPlaces::Merge(SegmentLabel dead, SegmentLabel survivor) {
  if (places_.size() <= Raw(dead)) return;
  if (places_.size() <= Raw(survivor)) places_.resize(Raw(survivor) + 1);
  const std::vector<BlockIndex>& from = places_[Raw(dead)];
  places_[Raw(survivor)].insert(places_[Raw(survivor)].end(), from.begin(), from.end());
}

void LabelPlaces::MergeAll(const LabelTable& labels) {
  const auto& records = labels.records();
  // A survivor has the lower label: from the highest label down, chains of merges are followed to
  // their end.
  for (size_t i = records.size(); i > 0; --i) {
    const SegmentLabel survivor = records[i - 1].merged_into;
    if (survivor != SegmentLabel::kNone) Merge(static_cast<SegmentLabel>(i), survivor);
  }
}

size_t LabelPlaces::bytes() const {
  constexpr size_t kEntry = sizeof(BlockIndex) + 12;
  size_t bytes =
      known_.bucket_count() * kEntry + places_.capacity() * sizeof(std::vector<BlockIndex>);
  for (const std::vector<BlockIndex>& blocks : places_)
    bytes += blocks.capacity() * sizeof(BlockIndex);
  return bytes;
}

std::span<const BlockIndex> LabelPlaces::BlocksOf(SegmentLabel label) const {
  const size_t at = Raw(label);
  return at < places_.size() ? std::span<const BlockIndex>(places_[at])
                             : std::span<const BlockIndex>();
}

}  // namespace vismap
