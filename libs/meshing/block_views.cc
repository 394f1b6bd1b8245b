#include "meshing/block_views.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/prefetch.h"

namespace vismap {
namespace {

constexpr std::array<uint64_t, kBlockSide> AllBits() {
  std::array<uint64_t, kBlockSide> bits{};
  bits.fill(~uint64_t{0});
  return bits;
}
constexpr std::array<uint64_t, kBlockSide> kAllBits = AllBits();
constexpr BlockView kUnseen;

ObservationGate GateOf(const MeshingOptions& options) {
  constexpr uint16_t kMost = std::numeric_limits<uint16_t>::max();
  const double weight = options.min_weight * static_cast<double>(kWeightScale);
  return {static_cast<uint16_t>(std::clamp(weight, 0.0, static_cast<double>(kMost))),
          static_cast<uint16_t>(std::clamp<int>(options.min_observations, 0, kMost))};
}

// Free blocks count no more than two observations, so two are enough for them.
const uint64_t* ObservedFree(const Block& block, int min_observations) {
  if (block.all_free) return kAllBits.data();
  if (!block.free) return nullptr;
  return min_observations <= 1 ? block.free->once.data() : block.free->twice.data();
}

void ReadSurface(const BlockView& view, const ObservationGate& gate, VoxelSigns* signs) {
  if (view.voxels != nullptr) return ReadSigns(*view.voxels, gate, *signs);
  SurfaceVoxels copy;
  view.block->surface.CopyTo(&copy);
  ReadSigns(copy, gate, *signs);
}

// Prefetches what ReadSurface reads of a block that is not packed.
void PrefetchSurface(const BlockView& view) {
  if (view.voxels == nullptr) return;
  PrefetchAll(view.voxels->distance);
  PrefetchAll(view.voxels->weight);
}

bool HasBits(const std::array<uint64_t, kBlockSide>& bits) {
  uint64_t all = 0;
  for (const uint64_t word : bits) all |= word;
  return all != 0;
}

}  // namespace

BlockViews::BlockViews(const VoxelMap& map, const std::vector<BlockIndex>& blocks)
    : views_(blocks.size()) {
  constexpr size_t kGroup = 512;
  ParallelForGroups(blocks.size(), kGroup, [&](size_t from, size_t to) {
    VoxelMap::Reader reader = map.reader();
    for (size_t i = from; i < to; ++i) {
      BlockView& view = views_[i];
      view.index = blocks[i];
      view.block = reader.Find(blocks[i]);
      if (view.block == nullptr || !view.block->surface) continue;
      view.has_surface = true;
      view.voxels = view.block->surface.get();
    }
  });
  for (const BlockView& view : views_) {
    const auto [x, y, z] = view.index;
    if (columns_.empty() || columns_.back().x != x || columns_.back().y != y)
      columns_.push_back({x, y, &view, &view});
    columns_.back().end = &view + 1;
  }
}

std::vector<BlockIndex> BlockViews::WithSurface() const {
  std::vector<BlockIndex> blocks;
  for (const BlockView& view : views_) {
    if (view.has_surface) blocks.push_back(view.index);
  }
  return blocks;
}

void BlockViews::ReadVoxels(const MeshingOptions& options) {
  const ObservationGate gate = GateOf(options);
  std::vector<BlockView*> surfaces;
  for (BlockView& view : views_) {
    if (view.has_surface) {
      surfaces.push_back(&view);
    } else if (view.block != nullptr) {
      view.observed = ObservedFree(*view.block, options.min_observations);
    }
  }
  signs_.resize(surfaces.size());
  constexpr size_t kAhead = 2;
  ParallelFor(surfaces.size(), 32, [&](size_t i) {
    if (i + kAhead < surfaces.size()) PrefetchSurface(*surfaces[i + kAhead]);
    ReadSurface(*surfaces[i], gate, &signs_[i]);
    surfaces[i]->observed = signs_[i].observed.data();
    if (HasBits(signs_[i].behind)) surfaces[i]->behind = signs_[i].behind.data();
  });
}

void NeighbourWalk::GoTo(BlockIndex block) {
  const bool same_columns = started_ && block.x == block_.x && block.y == block_.y;
  block_ = block;
  started_ = true;
  if (!same_columns) FindColumns();
  for (int x = 0; x <= 1; ++x) {
    for (int y = 0; y <= 1; ++y) FindAlong(x, y);
  }
}

void NeighbourWalk::FindLower() {
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      if (x < 0 || y < 0) FindAlong(x, y);
    }
  }
}

const BlockView* NeighbourWalk::Next() const {
  const Rest& rest = rests_[NeighbourSlot(0, 0, -1) / 3];
  const std::vector<BlockView>& all = views_.views();
  const BlockView* view = rest.begin;
  while (view != rest.end && view->index.z <= block_.z) ++view;
  for (const BlockView* end = all.data() + all.size(); view != nullptr && view != end; ++view) {
    if (view->behind != nullptr) return view;
  }
  return nullptr;
}

void NeighbourWalk::FindColumns() {
  for (int x = -1; x <= 1; ++x) {
    const std::pair first(block_.x + x, block_.y - 1);
    auto column = std::lower_bound(views_.columns().begin(), views_.columns().end(), first,
                                   [](const BlockViews::Column& a, const std::pair<int, int>& b) {
                                     return std::pair(a.x, a.y) < b;
                                   });
    for (int y = -1; y <= 1; ++y) {
      Rest& rest = rests_[NeighbourSlot(x, y, -1) / 3];
      rest = {};
      if (column == views_.columns().end() || column->x != block_.x + x ||
          column->y != block_.y + y)
        continue;
      rest = {column->begin, column->end};
      ++column;
    }
  }
}

inline void NeighbourWalk::FindAlong(int x, int y) {
  Rest& rest = rests_[NeighbourSlot(x, y, -1) / 3];
  while (rest.begin != rest.end && rest.begin->index.z < block_.z - 1) ++rest.begin;
  const BlockView* next = rest.begin;
  for (int z = -1; z <= 1; ++z) {
    const bool is_there = next != rest.end && next->index.z == block_.z + z;
    found_[NeighbourSlot(x, y, z)] = is_there ? next : &kUnseen;
    next += is_there ? 1 : 0;
  }
}

}  // namespace vismap
