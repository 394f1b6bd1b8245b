#include "navigation/object_surroundings.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "map/surface_reader.h"

namespace vismap {
namespace {

constexpr int kSpreadSteps = 8;
constexpr double kSampleVoxels = 0.75;  // samples are within this distance of the surface

}  // namespace

SurroundingsReader::SurroundingsReader(const SemanticMap& map, std::span<const SegmentLabel> labels,
                                       const OccupancyOptions& options)
    : map_(map),
      options_(options),
      free_min_(static_cast<int>(std::ceil(
          options.free_min_voxels / map.voxels.options().truncation_voxels * kTruncationSteps))) {
  for (const SegmentLabel label : labels) surfaces_[map.labels.Canonical(label)] = kObjectSurface;
}

uint8_t SurroundingsReader::NumberOf(SegmentLabel label) {
  const auto [found, is_new] = surfaces_.try_emplace(label, kNoSurface);
  if (is_new) found->second = static_cast<uint8_t>(std::min<size_t>(surfaces_.size() + 1, 255));
  return found->second;
}

SurroundingBlock SurroundingsReader::Read(BlockIndex index) {
  SurroundingBlock read;
  read.index = index;
  const Block* block = map_.voxels.Find(index);
  if (block == nullptr) return read;
  read.plain = ClassifyBlock(*block, map_.voxels.options(), options_).Planes();
  SurfaceReader reader;
  if (const SurfaceVoxels* voxels = reader.Read(*block)) ReadVoxels(*voxels, &read);
  // Thin things occupy voxels whose distance does not show them.
  for (size_t i = 0; i < read.band.size(); ++i) read.band[i] |= read.plain.occupied[i];
  return read;
}

void SurroundingsReader::ReadVoxels(const SurfaceVoxels& voxels, SurroundingBlock* block) {
  std::array<SegmentLabel, 256> canonical{};
  std::array<uint8_t, 256> numbers{};
  for (size_t i = 0; i < voxels.palette.size(); ++i) {
    canonical[i + 1] = map_.labels.Canonical(voxels.palette[i]);
    numbers[i + 1] = NumberOf(canonical[i + 1]);
  }
  const double voxels_per_step = map_.voxels.options().truncation_voxels / kTruncationSteps;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    if (voxels.weight[i] == 0 || voxels.distance[i] >= free_min_) continue;
    const uint64_t bit = uint64_t{1} << (i % 64);
    block->band[i / 64] |= bit;
    const auto& entries = voxels.slot_label[i];
    std::array<LabelVote, kVoteSlots> votes{};
    for (size_t slot = 0; slot < kVoteSlots; ++slot)
      votes[slot] = {canonical[entries[slot]], voxels.slot_votes[i][slot]};
    const SegmentLabel label = StrongestLabel(votes);
    if (label == SegmentLabel::kNone) continue;
    const size_t slot = votes[0].label == label ? 0 : votes[1].label == label ? 1 : 2;
    const uint8_t surface = numbers[entries[slot]];
    block->surface[i] = surface;
    block->voted[i / 64] |= bit;
    block->has_object = block->has_object || surface == kObjectSurface;
    const double distance = voxels.distance[i] * voxels_per_step;
    if (surface == kObjectSurface || std::abs(distance) > kSampleVoxels) continue;
    const auto at = static_cast<int>(i);
    block->samples.push_back({Eigen::Vector3f(static_cast<float>(8 * block->index.x + at % 8),
                                              static_cast<float>(8 * block->index.y + at / 8 % 8),
                                              static_cast<float>(8 * block->index.z + at / 64)),
                              static_cast<float>(distance), surface});
  }
}

NearSpace::NearSpace(std::vector<SurroundingBlock> blocks) : blocks_(std::move(blocks)) {
  BlockTable<int32_t> slots;
  for (size_t i = 0; i < blocks_.size(); ++i)
    slots.FindOrCreate(blocks_[i].index) = static_cast<int32_t>(i);
  beside_.resize(blocks_.size());
  BlockTable<int32_t>::Reader reader(slots);
  for (size_t i = 0; i < blocks_.size(); ++i) {
    const BlockIndex at = blocks_[i].index;
    for (int slot = 0; slot < 27; ++slot) {
      const int32_t* found =
          reader.Find({at.x + slot % 3 - 1, at.y + slot / 3 % 3 - 1, at.z + slot / 9 - 1});
      beside_[i][static_cast<size_t>(slot)] = found == nullptr ? -1 : *found;
    }
  }
}

NearVoxel NearSpace::Beside(NearVoxel voxel, int dx, int dy, int dz) const {
  const int offset = voxel % kBlockVoxels;
  const int x = offset % 8 + dx, y = offset / 8 % 8 + dy, z = offset / 64 + dz;
  const int slot = ((x + 8) >> 3) + 3 * ((y + 8) >> 3) + 9 * ((z + 8) >> 3);
  const int32_t block =
      beside_[static_cast<size_t>(voxel) / kBlockVoxels][static_cast<size_t>(slot)];
  return block < 0 ? -1 : block * kBlockVoxels + LinearIndex(x & 7, y & 7, z & 7);
}

VoxelIndex NearSpace::IndexOf(NearVoxel voxel) const {
  const BlockIndex block = BlockOf(voxel).index;
  const int offset = voxel % kBlockVoxels;
  return {8 * block.x + offset % 8, 8 * block.y + offset / 8 % 8, 8 * block.z + offset / 64};
}

Eigen::Vector3f NearSpace::PlaceOf(NearVoxel voxel) const {
  const VoxelIndex index = IndexOf(voxel);
  return {static_cast<float>(index.x), static_cast<float>(index.y), static_cast<float>(index.z)};
}

void NearSpace::SpreadSurfaces() {
  std::array<std::vector<NearVoxel>, 2> edges;  // of other surfaces, and of the objects
  for (NearVoxel voxel = 0; voxel < size(); ++voxel) {
    const uint8_t surface = Surface(voxel);
    if (surface != kNoSurface) edges[surface == kObjectSurface ? 1 : 0].push_back(voxel);
  }
  for (int step = 0; step < kSpreadSteps; ++step) {
    for (std::vector<NearVoxel>& edge : edges) {
      std::vector<NearVoxel> next;
      for (const NearVoxel voxel : edge) {
        ForSides(voxel, [&](NearVoxel beside) {
          if (beside < 0 || !InBand(beside) || Surface(beside) != kNoSurface) return;
          Surface(beside) = Surface(voxel);
          next.push_back(beside);
        });
      }
      edge = std::move(next);
    }
  }
}

}  // namespace vismap
