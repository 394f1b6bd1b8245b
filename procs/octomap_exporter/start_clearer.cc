#include "octomap_exporter/start_clearer.h"

#include <algorithm>
#include <utility>

namespace vismap {

namespace {
constexpr double kLongestStep = 0.5;  // a robot that was farther away did not move on a line [m]
}  // namespace

Result<void> StartClearer::AddPath(std::span<const Eigen::Vector3d> path_W) {
  for (const Eigen::Vector3d& p_W : path_W) {
    std::vector<Eigen::Vector3d> step = {p_W};
    if (!last_W_.empty() && (p_W - last_W_.front()).norm() < kLongestStep)
      step.insert(step.begin(), last_W_.front());
    const Result<LeafSets> covered = CoveredUnknownLeaves(nothing_known_, body_, step);
    if (!covered) return tl::unexpected(covered.error());
    last_W_ = {p_W};
    for (const auto& [index, bits] : *covered) {
      VoxelBits& all = covered_[index];
      const VoxelBits before = all;
      for (size_t i = 0; i < all.size(); ++i) all[i] |= bits[i];
      if (all != before) news_.push_back(index);
    }
  }
  return {};
}

OccupancyDelta StartClearer::Update(const OccupancyMap& seen, std::span<const BlockIndex> changed) {
  std::vector<BlockIndex> blocks = std::exchange(news_, {});
  blocks.insert(blocks.end(), changed.begin(), changed.end());
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  OccupancyDelta delta{leaves_.cell_size(), false, {}};
  for (const BlockIndex& index : blocks) {
    BlockOccupancy block = seen.At(index);
    assumed_.erase(index);
    if (const auto covered = covered_.find(index); covered != covered_.end()) {
      const OccupancyPlanes planes = block.Planes();
      VoxelBits free{};
      for (size_t i = 0; i < free.size(); ++i)
        free[i] = covered->second[i] & ~(planes.free[i] | planes.occupied[i]);
      if (free != VoxelBits{}) {
        block = WithFreeLeaves(block, free);
        assumed_[index] = free;
      }
    }
    if (leaves_.Set(index, block)) delta.blocks.emplace_back(index, leaves_.At(index));
  }
  return delta;
}

std::vector<VoxelIndex> StartClearer::Assumed() const {
  std::vector<VoxelIndex> leaves;
  for (const auto& [index, bits] : assumed_) {
    for (int32_t bit = 0; bit < kBlockVoxels; ++bit) {
      if ((bits[static_cast<size_t>(bit) / 64] >> (bit % 64) & 1) == 0) continue;
      leaves.push_back({8 * index.x + bit % 8, 8 * index.y + bit / 8 % 8, 8 * index.z + bit / 64});
    }
  }
  return leaves;
}

}  // namespace vismap
