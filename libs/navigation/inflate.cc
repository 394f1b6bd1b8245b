#include "navigation/inflate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "base/require.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

constexpr int kSide = kBlockSide;
constexpr int kMostReach = kMostInflatedLeaves;
constexpr int kMostRows = kSide + 2 * kMostReach;  // along an axis, also leaves in a row: 64
static_assert(kMostRows == 64);

/// Squared gap of two leaves that are `d` leaves apart along an axis.
int64_t Gap2(int d) {
  const int64_t gap = std::max(0, std::abs(d) - 1);
  return gap * gap;
}

/// The largest integer less than (radius / leaf)^2: leaves with this squared gap or less are too
/// near. A radius that is a whole number of leaves but for rounding counts as whole.
int64_t LargestGap2Below(double radius, double leaf) {
  const double leaves = radius / leaf;
  const double squared = leaves * leaves;
  const auto below = static_cast<int64_t>(std::ceil(squared - 1e-9 * std::max(1.0, squared))) - 1;
  return std::max<int64_t>(below, radius > 0 ? 0 : -1);
}

uint64_t Shift(uint64_t bits, int left) { return left >= 0 ? bits << left : bits >> -left; }

/// The rows of leaves around a block: bit x + reach of Row(y + reach, z + reach) is set when the
/// leaf at (x, y, z) of the block is an obstacle; coordinates from -reach to 7 + reach.
struct Surroundings {
  std::array<uint64_t, static_cast<size_t>(kMostRows) * kMostRows> rows;
  int side = 0;  // rows along an axis

  uint64_t& Row(int y, int z) { return rows[static_cast<size_t>(z * side + y)]; }
};

/// For each half width, the rows of Surroundings after growth along x, eight bits each.
using GrownRows = std::vector<uint8_t>;

struct Scratch {
  Surroundings around;
  GrownRows grown;
};

/// Calls `visit(dx, dy, dz)` for all blocks within `reach` blocks.
template <typename Visit>
void ForEachNeighbour(int reach, const Visit& visit) {
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) visit(dx, dy, dz);
    }
  }
}

/// Adds the obstacles of the block that is (dx, dy, dz) blocks away.
void AddBlock(const VoxelBits& obstacles, int dx, int dy, int dz, int reach, Surroundings* around) {
  const int left = kSide * dx + reach;
  for (int z = 0; z < kSide; ++z) {
    const int row_z = kSide * dz + z + reach;
    const uint64_t layer = obstacles[static_cast<size_t>(z)];
    if (row_z < 0 || row_z >= around->side || layer == 0) continue;
    const int first = std::max(0, -(kSide * dy + reach));
    const int last = std::min(kSide, around->side - (kSide * dy + reach));
    for (int y = first; y < last; ++y) {
      around->Row(kSide * dy + y + reach, row_z) |= Shift((layer >> (kSide * y)) & 0xff, left);
    }
  }
}

/// Grows `count` rows of up to as many leaves as a Word has bits by every half width from 0 to
/// `reach`. Short rows are many to a vector register.
template <typename Word>
void GrowRowsOf(const uint64_t* rows, size_t count, int reach, uint8_t* grown) {
  std::array<Word, static_cast<size_t>(kMostRows) * kMostRows> narrow;
  for (size_t i = 0; i < count; ++i) narrow[i] = static_cast<Word>(rows[i]);
  for (size_t i = 0; i < count; ++i) grown[i] = static_cast<uint8_t>(narrow[i] >> reach);
  for (int width = 1; width <= reach; ++width) {
    const uint8_t* before = grown;
    grown += count;
    const int right = reach + width, left = reach - width;
    for (size_t i = 0; i < count; ++i)
      grown[i] = static_cast<uint8_t>(before[i] | narrow[i] >> right | narrow[i] >> left);
  }
}

void GrowRows(const Surroundings& around, int reach, GrownRows* grown) {
  const size_t count = static_cast<size_t>(around.side) * static_cast<size_t>(around.side);
  grown->resize(count * static_cast<size_t>(reach + 1));
  const auto grow = around.side <= 16   ? GrowRowsOf<uint16_t>
                    : around.side <= 32 ? GrowRowsOf<uint32_t>
                                        : GrowRowsOf<uint64_t>;
  grow(around.rows.data(), count, reach, grown->data());
}

uint64_t EightRows(const uint8_t* rows) {
  static_assert(std::endian::native == std::endian::little);
  uint64_t layer;
  std::memcpy(&layer, rows, sizeof(layer));
  return layer;
}

int32_t FloorEighth(int32_t leaf) { return leaf >> 3; }

bool AnySet(const VoxelBits& bits) {
  return std::any_of(bits.begin(), bits.end(), [](uint64_t word) { return word != 0; });
}

/// First and last coordinate of the bits along x, y and z.
struct BitBox {
  std::array<int, 3> first, last;
};

BitBox BoxOf(const VoxelBits& bits) {
  uint64_t slab = 0, layers = 0, rows = 0, columns = 0;
  for (size_t z = 0; z < bits.size(); ++z) {
    slab |= bits[z];
    layers |= uint64_t{bits[z] != 0} << z;
  }
  for (int y = 0; y < kSide; ++y) {
    const uint64_t row = (slab >> (kSide * y)) & 0xff;
    rows |= uint64_t{row != 0} << y;
    columns |= row;
  }
  BitBox box;
  size_t axis = 0;
  for (const uint64_t set : {columns, rows, layers}) {
    box.first[axis] = std::countr_zero(set);
    box.last[axis] = 63 - std::countl_zero(set);
    ++axis;
  }
  return box;
}

void SortUnique(std::vector<BlockIndex>* indices) {
  std::sort(indices->begin(), indices->end());
  indices->erase(std::unique(indices->begin(), indices->end()), indices->end());
}

const BlockOccupancy& Or(const BlockOccupancy* block, const BlockOccupancy& otherwise) {
  return block != nullptr ? *block : otherwise;
}

const BlockOccupancy kNothingKnown;

}  // namespace

Result<Inflater> Inflater::Make(double leaf_m, const InflateOptions& options) {
  Require(leaf_m > 0, "leaves have an edge of more than 0 m");
  const double most = std::round(kMostInflatedLeaves * leaf_m * 1e9) / 1e9;
  if (!(options.radius_m >= 0 && options.radius_m <= most * (1 + 1e-9))) {
    return Fail("octomap_exporter.robot_radius_m: expected 0 to " + ShortestText(most) +
                " m with leaves of " + ShortestText(leaf_m) + " m, found " +
                ShortestText(options.radius_m) + " m");
  }
  return Inflater(leaf_m, options, LargestGap2Below(options.radius_m, leaf_m));
}

Inflater::Inflater(double leaf_m, const InflateOptions& options, int64_t nearest_free_gap2)
    : unknown_(options.unknown), inflated_(leaf_m) {
  const auto near = [&](int64_t gap2) { return gap2 <= nearest_free_gap2; };
  while (reach_ < kMostReach && near(Gap2(reach_ + 1))) ++reach_;
  for (int dz = -reach_; dz <= reach_; ++dz) {
    for (int dy = -reach_; dy <= reach_; ++dy) {
      const int64_t across = Gap2(dy) + Gap2(dz);
      if (reach_ > 0 && !near(across)) continue;
      int width = 0;
      while (width < reach_ && near(across + Gap2(width + 1))) ++width;
      rows_.push_back({dy, dz, width});
    }
  }
}

VoxelBits Inflater::ObstaclesIn(const BlockOccupancy& block) const {
  const OccupancyPlanes planes = block.Planes();
  if (unknown_ == UnknownPolicy::kAbsent) return planes.occupied;
  VoxelBits obstacles;
  for (size_t i = 0; i < obstacles.size(); ++i) obstacles[i] = ~planes.free[i];
  return obstacles;
}

// The blocks whose leaves are within reach of the given bits.
void Inflater::AddAffected(BlockIndex index, const VoxelBits& differences,
                           std::vector<BlockIndex>* affected) const {
  const BitBox box = BoxOf(differences);
  const auto first = [&](int axis, int32_t block) {
    return block + FloorEighth(box.first[static_cast<size_t>(axis)] - reach_);
  };
  const auto last = [&](int axis, int32_t block) {
    return block + FloorEighth(box.last[static_cast<size_t>(axis)] + reach_);
  };
  for (int32_t x = first(0, index.x); x <= last(0, index.x); ++x) {
    for (int32_t y = first(1, index.y); y <= last(1, index.y); ++y) {
      for (int32_t z = first(2, index.z); z <= last(2, index.z); ++z)
        affected->push_back({x, y, z});
    }
  }
}

// Takes over the changed blocks, and returns the blocks of the copy that may be different now.
std::vector<BlockIndex> Inflater::TakeChanges(const OccupancyMap& leaves,
                                              std::span<const BlockIndex> changed) {
  std::vector<BlockIndex> affected;
  for (const BlockIndex& index : changed) {
    const BlockOccupancy& now = leaves.At(index);
    const BlockOccupancy before = Or(leaves_.Find(index), kNothingKnown);
    if (before == now) continue;
    VoxelBits differences = ObstaclesIn(before);
    const VoxelBits obstacles = ObstaclesIn(now);
    for (size_t i = 0; i < differences.size(); ++i) differences[i] ^= obstacles[i];
    affected.push_back(index);
    if (AnySet(differences)) AddAffected(index, differences, &affected);
    if (now.is(CellState::kUnknown)) {
      leaves_.Erase(index);
    } else {
      leaves_.FindOrCreate(index) = now;
    }
  }
  SortUnique(&affected);
  return affected;
}

// The leaves of a block that are too near to an obstacle.
VoxelBits Inflater::Grow(BlockTable<BlockOccupancy>::Reader* leaves, BlockIndex index) const {
  static thread_local Scratch scratch;
  Surroundings& around = scratch.around;
  around.side = kSide + 2 * reach_;
  std::fill_n(around.rows.begin(), around.side * around.side, 0);
  bool any = false;
  ForEachNeighbour((reach_ + kSide - 1) / kSide, [&](int dx, int dy, int dz) {
    const BlockIndex place{index.x + dx, index.y + dy, index.z + dz};
    const BlockOccupancy& block = Or(leaves->Find(place), kNothingKnown);
    if (block.is(CellState::kFree)) return;
    if (unknown_ == UnknownPolicy::kAbsent && block.is(CellState::kUnknown)) return;
    any = true;
    AddBlock(ObstaclesIn(block), dx, dy, dz, reach_, &around);
  });
  VoxelBits grown{};
  if (!any) return grown;
  GrowRows(around, reach_, &scratch.grown);
  const int side = around.side;
  for (const Reach& row : rows_) {
    const uint8_t* rows = scratch.grown.data() + side * side * row.half_width +
                          side * (row.dz + reach_) + row.dy + reach_;
    for (size_t z = 0; z < grown.size(); ++z, rows += side) grown[z] |= EightRows(rows);
  }
  return grown;
}

BlockOccupancy Inflater::Inflate(BlockTable<BlockOccupancy>::Reader* leaves,
                                 BlockIndex index) const {
  const BlockOccupancy block = Or(leaves->Find(index), kNothingKnown);
  const bool closed = unknown_ == UnknownPolicy::kOccupied;
  if (block.is(CellState::kOccupied) || (closed && block.is(CellState::kUnknown))) return block;
  const OccupancyPlanes before = block.Planes();
  const VoxelBits near = Grow(leaves, index);
  OccupancyPlanes now;
  for (size_t i = 0; i < near.size(); ++i) {
    const uint64_t known = before.free[i] | before.occupied[i];
    now.occupied[i] = before.occupied[i] | (closed ? near[i] & known : near[i]);
    now.free[i] = before.free[i] & ~near[i];
  }
  return BlockOccupancy(now);
}

OccupancyDelta Inflater::Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed) {
  Require(leaves.cell_size() == inflated_.cell_size(), "an Inflater has one size of leaves");
  const std::vector<BlockIndex> affected = TakeChanges(leaves, changed);
  std::vector<BlockOccupancy> now(affected.size());
  ParallelForGroups(affected.size(), 16, [&](size_t from, size_t to) {
    BlockTable<BlockOccupancy>::Reader reader(leaves_);
    for (size_t i = from; i < to; ++i) now[i] = Inflate(&reader, affected[i]);
  });
  OccupancyDelta delta{inflated_.cell_size(), false, {}};
  for (size_t i = 0; i < affected.size(); ++i) {
    if (inflated_.Set(affected[i], now[i])) delta.blocks.emplace_back(affected[i], now[i]);
  }
  return delta;
}

Result<OccupancyMap> Inflate(const OccupancyMap& leaves, const InflateOptions& options) {
  Result<Inflater> inflater = Inflater::Make(leaves.cell_size(), options);
  if (!inflater) return tl::unexpected(inflater.error());
  inflater->Update(leaves, leaves.SortedIndices());
  return std::move(*inflater).Take();
}

}  // namespace vismap
