#include "meshing/block_set.h"

#include <algorithm>
#include <array>
#include <bit>

namespace vismap {
namespace {

constexpr int kRunBits = 6;
constexpr int32_t kRunMask = (1 << kRunBits) - 1;

}  // namespace

BlockSet::BlockSet(std::span<const BlockIndex> blocks) {
  std::vector<BlockIndex> sorted;
  if (!std::is_sorted(blocks.begin(), blocks.end())) {
    sorted.assign(blocks.begin(), blocks.end());
    std::sort(sorted.begin(), sorted.end());
    blocks = sorted;
  }
  for (const BlockIndex& block : blocks)
    Append({block.x, block.y, block.z >> kRunBits}, uint64_t{1} << (block.z & kRunMask));
}

void BlockSet::Append(const BlockIndex& at, uint64_t bits) {
  if (bits == 0) return;
  if (!runs_.empty() && runs_.back().at == at) {
    runs_.back().bits |= bits;
  } else {
    runs_.push_back({at, bits});
  }
}

inline void BlockSet::Put(const BlockIndex& at, uint64_t bits) {
  if (bits == 0) return;
  auto place = runs_.end();
  while (place != runs_.begin() && at < (place - 1)->at) --place;
  if (place != runs_.begin() && (place - 1)->at == at) {
    (place - 1)->bits |= bits;
  } else {
    runs_.insert(place, {at, bits});
  }
}

inline void BlockSet::PutStepped(const BlockIndex& at, uint64_t down, uint64_t still, uint64_t up) {
  if ((down & 1) != 0) Put({at.x, at.y, at.z - 1}, down << kRunMask);
  Put(at, down >> 1 | still | up << 1);
  if (up >> kRunMask != 0) Put({at.x, at.y, at.z + 1}, up >> kRunMask);
}

BlockSet BlockSet::Grown(int below, int above) const {
  return GrownAlongZ(below, above)
      .GrownAside({0, 1, 0}, below, above)
      .GrownAside({1, 0, 0}, below, above);
}

BlockSet BlockSet::GrownAlongZ(int below, int above) const {
  BlockSet grown;
  grown.runs_.reserve(runs_.size());
  for (const auto& [at, bits] : runs_)
    grown.PutStepped(at, below > 0 ? bits : 0, bits, above > 0 ? bits : 0);
  return grown;
}

BlockSet BlockSet::GrownAside(const BlockIndex& step, int below, int above) const {
  const std::span<const Run> none, all = runs_;
  return Merge({{all, {0, 0, 0}},
                {below > 0 ? all : none, {-step.x, -step.y, 0}},
                {above > 0 ? all : none, step}});
}

BlockSet BlockSet::Merge(std::initializer_list<Moved> parts) {
  struct Rest {
    std::span<const Run> runs;  // never empty
    BlockIndex step, at{};
    void Move() {
      const BlockIndex& from = runs.front().at;
      at = {from.x + step.x, from.y + step.y, from.z};
    }
  };
  BlockSet merged;
  std::vector<Rest> rests;
  size_t runs = 0;
  for (const auto& [part, step] : parts) {
    if (part.empty()) continue;
    rests.push_back({part, step});
    rests.back().Move();
    runs = std::max(runs, part.size());
  }
  merged.runs_.reserve(2 * runs);
  while (!rests.empty()) {
    BlockIndex next = rests.front().at;
    for (const Rest& rest : rests) next = std::min(next, rest.at);
    uint64_t bits = 0;
    bool one_ended = false;
    for (Rest& rest : rests) {
      if (rest.at != next) continue;
      bits |= rest.runs.front().bits;
      rest.runs = rest.runs.subspan(1);
      one_ended = one_ended || rest.runs.empty();
      if (!rest.runs.empty()) rest.Move();
    }
    merged.runs_.push_back({next, bits});
    if (one_ended) std::erase_if(rests, [](const Rest& rest) { return rest.runs.empty(); });
  }
  return merged;
}

BlockSet BlockSet::AffectedBy(const BlockChanges& changes) {
  if (changes.affected.empty()) return BlockSet(changes.blocks).Grown(1, 1);
  // Per run of changed blocks, which of them affect all neighbours, and each one.
  struct Affecting {
    BlockIndex at;
    uint64_t all = 0;
    std::array<uint64_t, kNeighbourSlots> bits{};
  };
  std::vector<Affecting> affecting;
  for (size_t i = 0; i < changes.blocks.size(); ++i) {
    const auto& [x, y, z] = changes.blocks[i];
    const BlockIndex at{x, y, z >> kRunBits};
    if (affecting.empty() || affecting.back().at != at) affecting.push_back({at});
    Affecting& run = affecting.back();
    const uint64_t bit = uint64_t{1} << (z & kRunMask);
    if (changes.affected[i] == kAllNeighbours) {
      run.all |= bit;
    } else {
      for (NeighbourBits rest = changes.affected[i]; rest != 0; rest &= rest - 1)
        run.bits[static_cast<size_t>(std::countr_zero(rest))] |= bit;
    }
  }
  std::array<BlockSet, 3> sides;  // along x, not yet moved to where they are; so are the columns
  for (size_t x = 0; x < 3; ++x) {
    std::array<BlockSet, 3> columns;
    for (size_t y = 0; y < 3; ++y) {
      const size_t slot = 3 * (y + 3 * x);
      for (const auto& [at, all, bits] : affecting)
        columns[y].PutStepped(at, bits[slot] | all, bits[slot + 1] | all, bits[slot + 2] | all);
    }
    sides[x] = Merge({{columns[0].runs_, {0, -1, 0}},
                      {columns[1].runs_, {0, 0, 0}},
                      {columns[2].runs_, {0, 1, 0}}});
  }
  return Merge(
      {{sides[0].runs_, {-1, 0, 0}}, {sides[1].runs_, {0, 0, 0}}, {sides[2].runs_, {1, 0, 0}}});
}

BlockSet BlockSet::Union(const BlockSet& other) const {
  BlockSet both;
  both.runs_.reserve(runs_.size() + other.runs_.size());
  auto a = runs_.begin(), b = other.runs_.begin();
  while (a != runs_.end() || b != other.runs_.end()) {
    const bool first = b == other.runs_.end() || (a != runs_.end() && a->at < b->at);
    const Run& next = first ? *a++ : *b++;
    both.Append(next.at, next.bits);
  }
  return both;
}

BlockSet BlockSet::Intersection(const BlockSet& other) const {
  BlockSet common;
  auto b = other.runs_.begin();
  for (const Run& run : runs_) {
    while (b != other.runs_.end() && b->at < run.at) ++b;
    if (b != other.runs_.end() && b->at == run.at) common.Append(run.at, run.bits & b->bits);
  }
  return common;
}

size_t BlockSet::size() const {
  size_t count = 0;
  for (const Run& run : runs_) count += static_cast<size_t>(std::popcount(run.bits));
  return count;
}

std::vector<BlockIndex> BlockSet::Blocks() const {
  std::vector<BlockIndex> blocks;
  blocks.reserve(size());
  for (const Run& run : runs_) {
    for (uint64_t bits = run.bits; bits != 0; bits &= bits - 1)
      blocks.push_back({run.at.x, run.at.y, (run.at.z << kRunBits) + std::countr_zero(bits)});
  }
  return blocks;
}

}  // namespace vismap
