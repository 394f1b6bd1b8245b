#include "meshing/block_set.h"

#include <algorithm>
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

// Merges the runs with copies of them that are moved by a step along x or y.
BlockSet BlockSet::GrownAside(const BlockIndex& step, int below, int above) const {
  struct Copy {
    std::span<const Run> runs;  // never empty
    BlockIndex step, at{};
    void Move() {
      const BlockIndex& from = runs.front().at;
      at = {from.x + step.x, from.y + step.y, from.z};
    }
  };
  BlockSet grown;
  if (runs_.empty()) return grown;
  grown.runs_.reserve(2 * runs_.size());
  std::vector<Copy> copies{{runs_, {0, 0, 0}}};
  if (below > 0) copies.push_back({runs_, {-step.x, -step.y, 0}});
  if (above > 0) copies.push_back({runs_, step});
  for (Copy& copy : copies) copy.Move();
  while (!copies.empty()) {
    BlockIndex next = copies.front().at;
    for (const Copy& copy : copies) next = std::min(next, copy.at);
    uint64_t bits = 0;
    bool one_ended = false;
    for (Copy& copy : copies) {
      if (copy.at != next) continue;
      bits |= copy.runs.front().bits;
      copy.runs = copy.runs.subspan(1);
      one_ended = one_ended || copy.runs.empty();
      if (!copy.runs.empty()) copy.Move();
    }
    grown.runs_.push_back({next, bits});
    if (one_ended) std::erase_if(copies, [](const Copy& copy) { return copy.runs.empty(); });
  }
  return grown;
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
