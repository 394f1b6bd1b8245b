#pragma once

#include <memory>
#include <vector>

#include "map/label_votes.h"
#include "map/voxel_map.h"

namespace vismap::naive {

// All that the naive code knows of how voxels are stored.

/// One voxel of a block near a surface, in the units that it is stored in.
struct StoredVoxel {
  int16_t distance = 0;  ///< in steps of truncation / kTruncationSteps
  uint16_t weight = 0;   ///< in steps of 1 / kWeightScale; 0 = unseen
  uint8_t observations = 0;
  Rgb8 color;
};

inline StoredVoxel ReadVoxel(const SurfaceVoxels& voxels, int offset) {
  const auto i = static_cast<size_t>(offset);
  return {voxels.distance[i], voxels.weight[i], voxels.observations[i], voxels.color[i]};
}

inline void WriteVoxel(SurfaceVoxels& voxels, int offset, const StoredVoxel& voxel) {
  const auto i = static_cast<size_t>(offset);
  voxels.distance[i] = voxel.distance;
  voxels.weight[i] = voxel.weight;
  voxels.observations[i] = voxel.observations;
  voxels.color[i] = voxel.color;
}

/// The votes of a voxel, by slot; without empty ones.
inline std::vector<LabelVote> ReadVotes(const SurfaceVoxels& voxels, int offset) {
  std::vector<LabelVote> votes;
  for (int slot = 0; slot < kVoteSlots; ++slot) {
    const LabelVote vote = voxels.Vote(offset, slot);
    if (vote.label != SegmentLabel::kNone && vote.votes > 0) votes.push_back(vote);
  }
  return votes;
}

/// How often the voxel of a block without surface was seen empty; two stands for more.
inline int TimesSeenFree(const Block& block, int offset) {
  if (block.all_free) return 2;
  if (!block.free) return 0;
  return block.free->SeenTwice(offset) ? 2 : block.free->SeenOnce(offset) ? 1 : 0;
}

/// Counts the voxel of a block without surface as seen empty; true when that was news.
inline bool SeeFree(Block& block, int offset) {
  const int times = TimesSeenFree(block, offset);
  if (times == 2) return false;
  if (!block.free) block.free = std::make_unique<FreeVoxels>();
  const auto word = static_cast<size_t>(offset / 64);
  (times == 0 ? block.free->once : block.free->twice)[word] |= uint64_t{1} << (offset % 64);
  return true;
}

/// A block of which every voxel was seen empty twice needs no bits.
inline void DropFullBits(Block& block) {
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (TimesSeenFree(block, offset) < 2) return;
  }
  block.free.reset();
  block.all_free = true;
}

/// A surface came near: the block gets voxels, which remember how often they were seen empty.
inline void MakeSurface(Block& block) {
  auto voxels = std::make_unique<SurfaceVoxels>();
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    const int times = TimesSeenFree(block, offset);
    if (times == 0) continue;
    const auto quarter = static_cast<uint16_t>(static_cast<float>(times) * kWeightScale * 0.25F);
    WriteVoxel(*voxels, offset, {kTruncationSteps, quarter, static_cast<uint8_t>(times), {}});
  }
  block = Block{};
  block.surface = std::move(voxels);
}

}  // namespace vismap::naive
