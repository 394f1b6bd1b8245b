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

BlockSet BlockSet::Grown(int below, int above) const {
  return GrownAlongZ(below, above)
      .GrownAside({0, 1, 0}, below, above)
      .GrownAside({1, 0, 0}, below, above);
}

BlockSet BlockSet::GrownAlongZ(int below, int above) const {
  BlockSet grown, before, behind;  // what steps into the next run is little
  grown.runs_.reserve(runs_.size());
  for (const auto& [at, bits] : runs_) {
    grown.Append(at, bits | (below > 0 ? bits >> 1 : 0) | (above > 0 ? bits << 1 : 0));
    before.Append({at.x, at.y, at.z - 1}, below > 0 ? bits << kRunMask : 0);
    behind.Append({at.x, at.y, at.z + 1}, above > 0 ? bits >> kRunMask : 0);
  }
  if (!before.runs_.empty()) grown = grown.Union(before);
  if (!behind.runs_.empty()) grown = grown.Union(behind);
  return grown;
}

BlockSet BlockSet::GrownAside(const BlockIndex& step, int below, int above) const {
  std::vector<Moved> copies{{runs_, {0, 0, 0}}};
  if (below > 0) copies.push_back({runs_, {-step.x, -step.y, 0}});
  if (above > 0) copies.push_back({runs_, step});
  return Merge(copies);
}

BlockSet BlockSet::Merge(std::span<const Moved> parts) {
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
  // Per run of changed blocks, which of them affect the neighbour in each slot.
  struct Affecting {
    BlockIndex at;
    std::array<uint64_t, kNeighbourSlots> bits{};
  };
  std::vector<Affecting> all;
  for (size_t i = 0; i < changes.blocks.size(); ++i) {
    const auto& [x, y, z] = changes.blocks[i];
    const BlockIndex at{x, y, z >> kRunBits};
    if (all.empty() || all.back().at != at) all.push_back({at});
    const int bit = z & kRunMask;
    for (size_t slot = 0; slot < kNeighbourSlots; ++slot)
      all.back().bits[slot] |= uint64_t{changes.affected[i] >> slot & 1} << bit;
  }
  // The affected blocks of each column of neighbours, not yet moved to it; and what steps into
  // another run, which is little.
  std::array<BlockSet, kNeighbourSlots / 3> columns, before, behind;
  std::array<Moved, 3 * (kNeighbourSlots / 3)> parts;
  for (size_t column = 0; column < columns.size(); ++column) {
    for (const auto& [at, bits] : all) {
      const uint64_t below = bits[3 * column], own = bits[3 * column + 1],
                     above = bits[3 * column + 2];
      columns[column].Append(at, below >> 1 | own | above << 1);
      before[column].Append({at.x, at.y, at.z - 1}, below << kRunMask);
      behind[column].Append({at.x, at.y, at.z + 1}, above >> kRunMask);
    }
    const auto number = static_cast<int32_t>(column);
    const BlockIndex step{number / 3 - 1, number % 3 - 1, 0};
    parts[3 * column] = {columns[column].runs_, step};
    parts[3 * column + 1] = {before[column].runs_, step};
    parts[3 * column + 2] = {behind[column].runs_, step};
  }
  return Merge(parts);
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
