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

BlockSet BlockSet::Shifted(const BlockIndex& step) const {
  BlockSet shifted;
  shifted.runs_.reserve(runs_.size() * (step.z == 0 ? 1 : 2));
  for (const Run& run : runs_) {
    const BlockIndex at{run.at.x + step.x, run.at.y + step.y, run.at.z};
    if (step.z < 0) shifted.Append({at.x, at.y, at.z - 1}, run.bits << kRunMask);
    shifted.Append(at, step.z < 0 ? run.bits >> 1 : run.bits << step.z);
    if (step.z > 0) shifted.Append({at.x, at.y, at.z + 1}, run.bits >> kRunMask);
  }
  return shifted;
}

BlockSet BlockSet::Grown(int below, int above) const {
  BlockSet grown = *this;
  for (const BlockIndex& axis : {BlockIndex{0, 0, 1}, BlockIndex{0, 1, 0}, BlockIndex{1, 0, 0}}) {
    const BlockSet before = grown;
    if (below > 0) grown = grown.Union(before.Shifted({-axis.x, -axis.y, -axis.z}));
    if (above > 0) grown = grown.Union(before.Shifted(axis));
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
