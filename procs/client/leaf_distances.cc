#include "client/leaf_distances.h"

#include <algorithm>
#include <cmath>

#include "map/block.h"
#include "navigation/distance_kernels.h"

namespace vismap {
namespace {

constexpr double kMostLeaf = 1 << 30;  // so that indices of leaves fit 32 bits

double LengthOf(uint16_t square, double leaf_m, double limit_m) {
  return square == kBeyond ? limit_m : std::sqrt(square) * leaf_m / 2;
}

/// The leaf whose index is `steps`, which are whole numbers.
const BlockDistances* Find(const SharedDistanceBlocks& blocks, const std::array<double, 3>& steps,
                           size_t* leaf) {
  std::array<int32_t, 3> index{};
  for (size_t axis = 0; axis < 3; ++axis) {
    if (!(std::abs(steps[axis]) < kMostLeaf)) return nullptr;
    index[axis] = static_cast<int32_t>(steps[axis]);
  }
  const VoxelIndex voxel{index[0], index[1], index[2]};
  const BlockIndex block = BlockOf(voxel);
  const auto found =
      std::lower_bound(blocks.begin(), blocks.end(), block,
                       [](const auto& entry, const BlockIndex& key) { return entry.first < key; });
  if (found == blocks.end() || found->first != block) return nullptr;
  *leaf = static_cast<size_t>(OffsetInBlock(voxel));
  return found->second.get();
}

std::array<double, 3> StepsOf(const std::array<double, 3>& p_W, double leaf_m, double shift) {
  return {std::floor(p_W[0] / leaf_m + shift), std::floor(p_W[1] / leaf_m + shift),
          std::floor(p_W[2] / leaf_m + shift)};
}

}  // namespace

LeafDistances::LeafDistances(std::unique_ptr<const Field> field) : field_(std::move(field)) {}
LeafDistances::~LeafDistances() = default;

double LeafDistances::leaf_m() const { return field_->leaf_m; }
double LeafDistances::limit_m() const { return field_->limit_m; }

double LeafDistances::ToObstacle(const std::array<double, 3>& p_W) const {
  size_t leaf = 0;
  const BlockDistances* block = Find(field_->blocks, StepsOf(p_W, leaf_m(), 0), &leaf);
  return block == nullptr ? 0 : LengthOf(block->obstacle[leaf], leaf_m(), limit_m());
}

double LeafDistances::ToUnknown(const std::array<double, 3>& p_W) const {
  size_t leaf = 0;
  const BlockDistances* block = Find(field_->blocks, StepsOf(p_W, leaf_m(), 0), &leaf);
  return block == nullptr ? 0 : LengthOf(block->unknown[leaf], leaf_m(), limit_m());
}

// No distance changes by more than the way between two points, so each centre around the point
// gives a bound.
double LeafDistances::FreeRadius(const std::array<double, 3>& p_W) const {
  const std::array<double, 3> first = StepsOf(p_W, leaf_m(), -0.5);
  double radius = 0;
  for (int corner = 0; corner < 8; ++corner) {
    std::array<double, 3> steps = first;
    double way2 = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      steps[axis] += corner >> axis & 1;
      way2 += std::pow((steps[axis] + 0.5) * leaf_m() - p_W[axis], 2);
    }
    size_t leaf = 0;
    const BlockDistances* block = Find(field_->blocks, steps, &leaf);
    if (block == nullptr) continue;
    const uint16_t square = std::min(block->obstacle[leaf], block->unknown[leaf]);
    radius = std::max(radius, LengthOf(square, leaf_m(), limit_m()) - std::sqrt(way2));
  }
  return radius;
}

}  // namespace vismap
