#include "meshing/block_set.h"

#include <algorithm>
#include <bit>

namespace vismap {
namespace {

constexpr int kRunBits = 6;
constexpr int32_t kRunMask = (1 << kRunBits) - 1;
constexpr double kMostRuns = 1 << 16;  // in a box that is held in memory as a whole

// All runs of a box, numbered ascending.
class RunBox {
 public:
  // The box around some blocks, at least one, and their neighbours.
  static RunBox Around(std::span<const BlockIndex> blocks) {
    BlockIndex low = blocks.front(), high = low;
    for (const auto& [x, y, z] : blocks) {
      low = {std::min(low.x, x), std::min(low.y, y), std::min(low.z, z)};
      high = {std::max(high.x, x), std::max(high.y, y), std::max(high.z, z)};
    }
    return RunBox({low.x - 1, low.y - 1, (low.z - 1) >> kRunBits},
                  {high.x + 1, high.y + 1, (high.z + 1) >> kRunBits});
  }

  size_t size() const { return Count(low_.x, high_.x) * step_x(); }
  bool IsLarge() const {  // in doubles, which do not overflow
    const auto count = [](int32_t from, int32_t to) {
      return static_cast<double>(Count(from, to));
    };
    return count(low_.x, high_.x) * count(low_.y, high_.y) * count(low_.z, high_.z) > kMostRuns;
  }
  size_t step_x() const { return Count(low_.y, high_.y) * step_y(); }
  size_t step_y() const { return Count(low_.z, high_.z); }
  size_t At(const BlockIndex& run) const {
    return Count(low_.x, run.x - 1) * step_x() + Count(low_.y, run.y - 1) * step_y() +
           Count(low_.z, run.z - 1);
  }
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    size_t i = 0;
    for (int x = low_.x; x <= high_.x; ++x) {
      for (int y = low_.y; y <= high_.y; ++y) {
        for (int z = low_.z; z <= high_.z; ++z) visit(BlockIndex{x, y, z}, i++);
      }
    }
  }

 private:
  RunBox(const BlockIndex& low, const BlockIndex& high) : low_(low), high_(high) {}
  static size_t Count(int32_t from, int32_t to) {
    return static_cast<size_t>(int64_t{to} - from + 1);
  }

  BlockIndex low_, high_;
};

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
      if (rest.at != next) continue;  // this part has no run at `next`
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
  return AffectedBy(changes.blocks, changes.affected);
}

BlockSet BlockSet::AffectedBy(std::span<const BlockIndex> changed,
                              std::span<const NeighbourBits> affected) {
  if (changed.empty()) return {};
  const RunBox box = RunBox::Around(changed);
  if (changed.size() > 1 && box.IsLarge()) {  // the blocks are far apart: halve the list
    const size_t half = changed.size() / 2;
    return AffectedBy(changed.first(half), affected.first(half))
        .Union(AffectedBy(changed.subspan(half), affected.subspan(half)));
  }
  std::vector<uint64_t> runs(box.size());
  for (size_t i = 0; i < changed.size(); ++i) {
    const auto& [x, y, z] = changed[i];
    // The three neighbours along z are three bits, mostly in one run.
    const int first = z - 1, shift = first & kRunMask;
    uint64_t* run = &runs[box.At({x - 1, y - 1, first >> kRunBits})];
    NeighbourBits left = affected[i];
    for (int along_x = 0; along_x < 3; ++along_x, run += box.step_x()) {
      uint64_t* column = run;
      for (int along_y = 0; along_y < 3; ++along_y, column += box.step_y(), left >>= 3) {
        const uint64_t three = left & 7;
        *column |= three << shift;
        if (shift > kRunMask - 2) column[1] |= three >> (kRunMask + 1 - shift);
      }
    }
  }
  BlockSet set;
  box.ForEach([&](const BlockIndex& at, size_t i) { set.Append(at, runs[i]); });
  return set;
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
