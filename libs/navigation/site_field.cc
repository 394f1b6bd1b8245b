#include "navigation/site_field.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "base/require.h"

namespace vismap {
namespace {

constexpr int kLines = kBlockVoxels / kBlockSide;  // of a block along an axis
constexpr uint64_t kAllRows = ~uint64_t{0};
constexpr int kMostReachBlocks = kMostHalfLeaves / 16 + 1;
constexpr int kMostBlocksInLine = 2 * kMostReachBlocks + 1;

uint16_t SquaredHalfLeaves(int leaves) {
  const int half_leaves = leaves == 0 ? 0 : 2 * leaves - 1;
  return static_cast<uint16_t>(half_leaves * half_leaves);
}

/// For each byte of eight sites in a row, the distance of the eight leaves to the nearest of them.
using NearestInByte = std::array<std::array<uint8_t, 8>, 256>;

constexpr NearestInByte MakeNearestInByte() {
  NearestInByte nearest{};
  for (int bits = 0; bits < 256; ++bits) {
    for (int x = 0; x < 8; ++x) {
      int least = kNoneInRow;
      for (int site = 0; site < 8; ++site) {
        const int distance = site > x ? site - x : x - site;
        if (((bits >> site) & 1) != 0 && distance < least) least = distance;
      }
      nearest[static_cast<size_t>(bits)][static_cast<size_t>(x)] = static_cast<uint8_t>(least);
    }
  }
  return nearest;
}

constexpr NearestInByte kNearestInByte = MakeNearestInByte();

uint8_t RowOf(const VoxelBits& bits, int row) {
  return static_cast<uint8_t>(bits[static_cast<size_t>(row / 8)] >> (8 * (row % 8)));
}

/// The rows in which any bit is set: bit y + 8 z.
uint64_t RowsWith(const VoxelBits& bits) {
  uint64_t rows = 0;
  for (int row = 0; row < kLines; ++row) rows |= uint64_t{RowOf(bits, row) != 0} << row;
  return rows;
}

VoxelBits Differences(const VoxelBits& a, const VoxelBits& b) {
  VoxelBits differences;
  for (size_t i = 0; i < a.size(); ++i) differences[i] = a[i] ^ b[i];
  return differences;
}

template <typename Values>
bool AllAre(const Values& values, typename Values::value_type value) {
  return std::all_of(values.begin(), values.end(), [&](auto v) { return v == value; });
}

template <typename Values>
const Values* Get(const std::unique_ptr<Values>* found) {
  return found != nullptr ? found->get() : nullptr;
}

/// The values of a task's block, to be written: those in the table, or new ones.
template <typename Values>
Values& ValuesToWrite(const Values* kept, typename Values::value_type outside,
                      std::unique_ptr<Values>* created) {
  if (kept != nullptr) return const_cast<Values&>(*kept);
  if (*created == nullptr) {
    *created = std::make_unique<Values>();
    (*created)->fill(outside);
  }
  return **created;
}

}  // namespace

struct SiteField::Work {
  BlockTable<uint64_t> changed_rows;   // rows whose sites changed
  std::vector<BlockIndex> fresh_rows;  // blocks that are wanted now and were not before
  std::vector<BlockIndex> fresh_planes;
  std::vector<BlockIndex> fresh_distances;
  std::vector<BlockIndex> dropped;  // blocks whose distances are no longer wanted
};

struct SiteField::RowTask {
  BlockIndex index;
  uint64_t rows = 0;  // to be computed again
  bool changed = false, uniform = false;
  std::unique_ptr<RowDistances> created{};
  std::unique_ptr<Touched> touched{};
};

struct SiteField::LineTask {
  BlockIndex index;
  bool fresh = false;
  bool changed = false, uniform = false;
  std::unique_ptr<Distances> created{};
  std::unique_ptr<Touched> touched{};
};

SiteField::SiteField(const SiteFieldOptions& options) : outside_is_site_(options.outside_is_site) {
  Require(options.most_half_leaves >= 1 && options.most_half_leaves <= kMostHalfLeaves,
          "the largest distance of a field is 1 to kMostHalfLeaves half leaves");
  most_ = static_cast<uint16_t>(options.most_half_leaves * options.most_half_leaves);
  window_ = (options.most_half_leaves + 1) / 2;
  reach_ = (window_ + kBlockSide - 1) / kBlockSide;
  outside_value_ = outside_is_site_ ? 0 : kBeyond;
  outside_row_ = outside_is_site_ ? 0 : kNoneInRow;
  outside_sites_.fill(outside_is_site_ ? ~uint64_t{0} : 0);
  for (size_t d = 0; d < cost_.size(); ++d) {
    const int leaves = static_cast<int>(d);
    cost_[d] = leaves <= window_ ? SquaredHalfLeaves(leaves) : kBeyond;
  }
}

const SiteField::Distances* SiteField::Find(BlockIndex index) const {
  return Get(distances_.Find(index));
}

size_t SiteField::bytes() const {
  return sites_.bytes() + users_.bytes() + rows_.bytes() + planes_.bytes() + distances_.bytes() +
         rows_.size() * sizeof(RowDistances) +
         (planes_.size() + distances_.size()) * sizeof(Distances);
}

const VoxelBits& SiteField::SitesIn(BlockIndex index) const {
  const VoxelBits* sites = sites_.Find(index);
  return sites != nullptr ? *sites : outside_sites_;
}

// In a field whose outside is a site, only blocks with a leaf that is none have values.
bool SiteField::HasOtherThanSites(BlockIndex index) const { return sites_.Find(index) != nullptr; }

bool SiteField::WantsRows(BlockIndex index) const {
  if (outside_is_site_) return HasOtherThanSites(index) || rows_.Find(index) != nullptr;
  const Users* users = users_.Find(index);
  return users != nullptr && users->rows > 0;
}

bool SiteField::WantsPlanes(BlockIndex index) const {
  if (outside_is_site_) return HasOtherThanSites(index) || planes_.Find(index) != nullptr;
  const Users* users = users_.Find(index);
  return users != nullptr && users->planes > 0;
}

bool SiteField::WantsDistances(BlockIndex index) const {
  if (outside_is_site_) return HasOtherThanSites(index) || distances_.Find(index) != nullptr;
  const Users* users = users_.Find(index);
  return users != nullptr && users->known;
}

void SiteField::SetSites(const SiteChange& change, Work* work) {
  const uint64_t rows = RowsWith(Differences(change.sites, SitesIn(change.index)));
  if (rows == 0) return;
  work->changed_rows.FindOrCreate(change.index) = rows;
  if (change.sites == outside_sites_) {
    sites_.Erase(change.index);
  } else {
    sites_.FindOrCreate(change.index) = change.sites;
  }
}

void SiteField::UseRows(BlockIndex index, int more, Work* work) {
  Users& users = users_.FindOrCreate(index);
  users.rows = static_cast<uint8_t>(users.rows + more);
  if (more > 0 && users.rows == 1) work->fresh_rows.push_back(index);
  if (users.rows > 0) return;
  rows_.Erase(index);
  if (users.planes == 0 && !users.known) users_.Erase(index);
}

void SiteField::UsePlanes(BlockIndex index, int more, Work* work) {
  Users& users = users_.FindOrCreate(index);
  users.planes = static_cast<uint8_t>(users.planes + more);
  const bool first = more > 0 && users.planes == 1;
  if (!first && users.planes > 0) return;
  if (first) {
    work->fresh_planes.push_back(index);
  } else {
    planes_.Erase(index);
  }
  for (int k = -reach_; k <= reach_; ++k) UseRows({index.x, index.y + k, index.z}, more, work);
}

void SiteField::SetKnown(BlockIndex index, bool known, Work* work) {
  const Users* before = users_.Find(index);
  if ((before != nullptr && before->known) == known) return;
  users_.FindOrCreate(index).known = known;
  if (known) {
    work->fresh_distances.push_back(index);
  } else {
    distances_.Erase(index);
    work->dropped.push_back(index);
  }
  const int more = known ? 1 : -1;
  for (int k = -reach_; k <= reach_; ++k) UsePlanes({index.x, index.y, index.z + k}, more, work);
}

void SiteField::TakeChanges(std::span<const SiteChange> changes, Work* work) {
  for (const SiteChange& change : changes) {
    SetSites(change, work);
    if (!outside_is_site_) SetKnown(change.index, change.known, work);
  }
}

// Rows whose sites changed, and the same rows of the blocks to both sides, as far as there are
// blocks without sites in between.
void SiteField::SpreadAlongRows(BlockIndex index, uint64_t rows, const Work& work,
                                BlockTable<uint64_t>* tasks) const {
  if (WantsRows(index)) tasks->FindOrCreate(index) |= rows;
  for (const int direction : {-1, 1}) {
    uint64_t left = rows;
    for (int k = 1; k <= reach_ && left != 0; ++k) {
      const BlockIndex place{index.x + direction * k, index.y, index.z};
      if (WantsRows(place)) tasks->FindOrCreate(place) |= left;
      const uint64_t* changed = work.changed_rows.Find(place);
      left &= ~(RowsWith(SitesIn(place)) & ~(changed != nullptr ? *changed : 0));
    }
  }
}

std::vector<SiteField::RowTask> SiteField::FindRowTasks(const Work& work) const {
  BlockTable<uint64_t> rows;
  work.changed_rows.ForEach(
      [&](BlockIndex index, uint64_t changed) { SpreadAlongRows(index, changed, work, &rows); });
  for (const BlockIndex& index : work.fresh_rows) {
    if (WantsRows(index)) rows.FindOrCreate(index) = kAllRows;
  }
  std::vector<RowTask> tasks;
  tasks.reserve(rows.size());
  rows.ForEach([&](BlockIndex index, uint64_t which) { tasks.push_back({index, which}); });
  return tasks;
}

// The step along x for one block: the bits of its rows and of those beside them.
class SiteField::RowStep {
 public:
  RowStep(const SiteField& field, RowTask* task) : field_(field), task_(task) {
    BlockTable<VoxelBits>::Reader reader(field.sites_);
    for (int k = -field.reach_; k <= field.reach_; ++k) {
      const VoxelBits* found = reader.Find({task->index.x + k, task->index.y, task->index.z});
      blocks_[static_cast<size_t>(k + field.reach_)] =
          found != nullptr ? found : &field.outside_sites_;
    }
  }

  void Run() {
    const RowDistances* kept = Get(field_.rows_.Find(task_->index));
    RowDistances& values = ValuesToWrite(kept, field_.outside_row_, &task_->created);
    task_->touched = std::make_unique<Touched>();
    task_->touched->fill(kBeyond);
    for (uint64_t left = task_->rows; left != 0; left &= left - 1)
      Compute(std::countr_zero(left), &values);
    task_->uniform = task_->changed && AllAre(values, field_.outside_row_);
  }

 private:
  uint8_t SitesIn(int k, int row) const {
    return RowOf(*blocks_[static_cast<size_t>(k + field_.reach_)], row);
  }

  // From the first or last leaf of the block to the nearest site beyond it [leaves].
  int FromEnd(int row, int direction) const {
    for (int k = 1; k <= field_.reach_; ++k) {
      const uint8_t bits = SitesIn(direction * k, row);
      if (bits == 0) continue;
      const int more = direction < 0 ? std::countl_zero(bits) : std::countr_zero(bits);
      return kBlockSide * (k - 1) + more + 1;
    }
    return kNoneInRow;
  }

  void Compute(int row, RowDistances* values) {
    const int before = FromEnd(row, -1), behind = FromEnd(row, 1);
    const auto& inside = kNearestInByte[SitesIn(0, row)];
    std::array<uint8_t, kBlockSide> now;
    for (int x = 0; x < kBlockSide; ++x) {
      const int least =
          std::min({int{inside[static_cast<size_t>(x)]}, before + x, behind + kBlockSide - 1 - x});
      now[static_cast<size_t>(x)] =
          static_cast<uint8_t>(least <= field_.window_ ? least : kNoneInRow);
    }
    uint8_t* kept = values->data() + kBlockSide * row;
    if (std::equal(now.begin(), now.end(), kept)) return;
    uint16_t* touched = task_->touched->data() + kBlockSide * (row / 8);
    for (size_t x = 0; x < now.size(); ++x) {
      if (kept[x] == now[x]) continue;
      touched[x] = std::min(touched[x], SquaredHalfLeaves(std::min(kept[x], now[x])));
      kept[x] = now[x];
    }
    task_->changed = true;
  }

  const SiteField& field_;
  RowTask* task_;
  std::array<const VoxelBits*, kMostBlocksInLine> blocks_{};
};

SiteField::TouchedBlocks SiteField::UpdateRows(const Work& work) {
  std::vector<RowTask> tasks = FindRowTasks(work);
  ParallelFor(tasks.size(), 8, [&](size_t i) { RowStep(*this, &tasks[i]).Run(); });
  TouchedBlocks touched;
  for (RowTask& task : tasks) {
    if (!task.changed) continue;
    touched.FindOrCreate(task.index) = std::move(task.touched);
    if (task.uniform) {
      rows_.Erase(task.index);
    } else if (task.created) {
      rows_.FindOrCreate(task.index) = std::move(task.created);
    }
  }
  return touched;
}

// The blocks along the axis of which a change can reach the values.
template <SiteField::Axis kAxis>
std::vector<SiteField::LineTask> SiteField::FindLineTasks(const TouchedBlocks& touched,
                                                          std::span<const BlockIndex> fresh) const {
  constexpr bool kAlongY = kAxis == Axis::kY;
  const auto wants = [&](BlockIndex index) {
    return kAlongY ? WantsPlanes(index) : WantsDistances(index);
  };
  BlockTable<uint8_t> found;  // 1 = perhaps, 2 = fresh
  touched.ForEach([&](BlockIndex index, const std::unique_ptr<Touched>& lines) {
    const uint16_t least = *std::min_element(lines->begin(), lines->end());
    for (int k = -reach_; k <= reach_; ++k) {
      const int gap = k == 0 ? 0 : kBlockSide * (std::abs(k) - 1) + 1;
      if (least + cost_[static_cast<size_t>(gap)] > most_) continue;
      const BlockIndex place{index.x, index.y + (kAlongY ? k : 0), index.z + (kAlongY ? 0 : k)};
      if (wants(place)) found.FindOrCreate(place) |= 1;
    }
  });
  for (const BlockIndex& index : fresh) {
    if (wants(index)) found.FindOrCreate(index) = 2;
  }
  std::vector<LineTask> tasks;
  tasks.reserve(found.size());
  found.ForEach([&](BlockIndex index, uint8_t kind) { tasks.push_back({index, kind == 2}); });
  return tasks;
}

// One step of the distances for one block, along y from the rows or along z from the planes. Works
// on chunks of 64 leaves, those of one layer in z; a line through a chunk has the stride 8 along y,
// and the stride 64 along z.
template <SiteField::Axis kAxis>
class SiteField::LineStep {
 public:
  LineStep(const SiteField& field, const TouchedBlocks& touched, LineTask* task)
      : field_(field), task_(task) {
    const auto& input = Input();
    typename std::decay_t<decltype(input)>::Reader blocks(input);
    TouchedBlocks::Reader changes(touched);
    for (int k = -field.reach_; k <= field.reach_; ++k) {
      blocks_[At(k)] = Get(blocks.Find(BlockAt(k)));
      changes_[At(k)] = Get(changes.Find(BlockAt(k)));
      if (changes_[At(k)] != nullptr) FindLeast(k);
    }
    kept_ = Get((kAlongY ? field.planes_ : field.distances_).Find(task->index));
    outside_.fill(field.outside_value_);
  }

  void Run() {
    for (int chunk = 0; chunk < kBlockSide; ++chunk) {
      if (task_->fresh || Affected(chunk)) Compute(chunk);
    }
    const Distances* result = kept_ != nullptr ? kept_ : task_->created.get();
    task_->uniform = task_->changed && AllAre(*result, field_.outside_value_);
  }

 private:
  static constexpr bool kAlongY = kAxis == Axis::kY;
  static constexpr ptrdiff_t kStride = kAlongY ? kBlockSide : kLines;
  using Values = std::conditional_t<kAlongY, RowDistances, Distances>;
  using Chunk = std::array<uint16_t, kLines>;
  /// The values of all blocks in a line: along y only the layer of a chunk, along z all layers.
  using LineValues = std::array<uint16_t, kMostBlocksInLine * kBlockVoxels>;

  const Level<Values>& Input() const {
    if constexpr (kAlongY) {
      return field_.rows_;
    } else {
      return field_.planes_;
    }
  }
  static LineValues& Buffer() {
    alignas(64) static thread_local LineValues values;
    return values;
  }
  size_t At(int k) const { return static_cast<size_t>(k + field_.reach_); }
  BlockIndex BlockAt(int k) const {
    const BlockIndex& at = task_->index;
    return kAlongY ? BlockIndex{at.x, at.y + k, at.z} : BlockIndex{at.x, at.y, at.z + k};
  }
  const uint16_t* Before(int chunk) const {
    return kept_ != nullptr ? kept_->data() + kLines * chunk : outside_.data();
  }

  // The least changed value of the lines that go through each chunk.
  void FindLeast(int k) {
    changed_.push_back(k);
    const Touched& lines = *changes_[At(k)];
    std::array<uint16_t, kBlockSide> least;
    least.fill(kBeyond);
    for (size_t i = 0; i < lines.size(); ++i)
      least[i / kBlockSide] = std::min(least[i / kBlockSide], lines[i]);
    if (!kAlongY) least.fill(*std::min_element(least.begin(), least.end()));
    least_[At(k)] = least;
  }

  // Whether a change can have made a value less, or was what made it as small as it is.
  bool Affected(int chunk) const {
    const uint16_t largest = std::min(Largest(Before(chunk)), field_.most_);
    for (const int k : changed_) {
      const uint16_t least = least_[At(k)][static_cast<size_t>(chunk)];
      const size_t gap = Gap(k, kAlongY ? (k < 0 ? 0 : kBlockSide - 1) : chunk);
      if (least + field_.cost_[gap] <= largest && AffectedBy(k, chunk)) return true;
    }
    return false;
  }

  // From the leaf `along` of the block to the nearest one of the block k blocks away.
  static size_t Gap(int k, int along) {
    const int first = kBlockSide * k;
    return static_cast<size_t>(std::max({0, first - along, along - (first + kBlockSide - 1)}));
  }

  bool AffectedBy(int k, int chunk) const {
    const uint16_t* lines = changes_[At(k)]->data();
    Chunk least, cost;
    for (int row = 0; row < kBlockSide; ++row) {
      const int line = kBlockSide * (kAlongY ? chunk : row);
      std::copy_n(lines + line, kBlockSide, least.begin() + kBlockSide * row);
      std::fill_n(cost.begin() + kBlockSide * row, kBlockSide,
                  field_.cost_[Gap(k, kAlongY ? row : chunk)]);
    }
    return AnyNear(least.data(), cost.data(), Before(chunk), field_.most_);
  }

  // Copies what a chunk needs of the blocks in the line.
  void Fill(int chunk) {
    if (!kAlongY && filled_) return;
    filled_ = true;
    uint16_t* out = Buffer().data();
    for (int k = -field_.reach_; k <= field_.reach_; ++k) {
      const Values* values = blocks_[At(k)];
      const size_t count = kAlongY ? kLines : kBlockVoxels;
      if (values == nullptr) {
        std::fill_n(out, count, field_.outside_value_);
      } else if constexpr (kAlongY) {
        SquareRowDistances(values->data() + kLines * chunk, out);
      } else {
        std::copy_n(values->data(), count, out);
      }
      out += count;
    }
  }

  void Compute(int chunk) {
    Fill(chunk);
    const ptrdiff_t first = kBlockSide * field_.reach_ + (kAlongY ? 0 : chunk);
    Chunk now;
    LeastAlongLine(Buffer().data() + first * kStride, kStride, field_.window_, field_.cost_.data(),
                   field_.most_, now.data());
    if (std::equal(now.begin(), now.end(), Before(chunk))) return;
    Touch(now, Before(chunk));
    Distances& values = ValuesToWrite(kept_, field_.outside_value_, &task_->created);
    std::copy(now.begin(), now.end(), values.begin() + kLines * chunk);
  }

  void Touch(const Chunk& now, const uint16_t* before) {
    if (!task_->changed) {
      task_->changed = true;
      task_->touched = std::make_unique<Touched>();
      task_->touched->fill(kBeyond);
    }
    for (size_t i = 0; i < now.size(); ++i) {
      const uint16_t least = now[i] != before[i] ? std::min(now[i], before[i]) : kBeyond;
      (*task_->touched)[i] = std::min((*task_->touched)[i], least);
    }
  }

  const SiteField& field_;
  LineTask* task_;
  std::array<const Values*, kMostBlocksInLine> blocks_{};  // nullptr = values as outside
  std::array<const Touched*, kMostBlocksInLine> changes_{};
  std::vector<int> changed_;  // the blocks in the line that changed, by their distance in blocks
  std::array<std::array<uint16_t, kBlockSide>, kMostBlocksInLine> least_;  // of these, by chunk
  const Distances* kept_ = nullptr;  // the result so far; nullptr = values as outside
  Chunk outside_;
  bool filled_ = false;
};

template <SiteField::Axis kAxis>
SiteField::TouchedBlocks SiteField::UpdateLines(const TouchedBlocks& touched,
                                                std::span<const BlockIndex> fresh,
                                                std::vector<BlockIndex>* changed) {
  std::vector<LineTask> tasks = FindLineTasks<kAxis>(touched, fresh);
  ParallelFor(tasks.size(), 4, [&](size_t i) { LineStep<kAxis>(*this, touched, &tasks[i]).Run(); });
  Level<Distances>& level = kAxis == Axis::kY ? planes_ : distances_;
  TouchedBlocks next;
  for (LineTask& task : tasks) {
    if (!task.changed) continue;
    if (changed != nullptr) changed->push_back(task.index);
    next.FindOrCreate(task.index) = std::move(task.touched);
    if (task.uniform) {
      level.Erase(task.index);
    } else if (task.created) {
      level.FindOrCreate(task.index) = std::move(task.created);
    }
  }
  return next;
}

std::vector<BlockIndex> SiteField::Update(std::span<const SiteChange> changes) {
  Work work;
  TakeChanges(changes, &work);
  const TouchedBlocks rows = UpdateRows(work);
  const TouchedBlocks planes = UpdateLines<Axis::kY>(rows, work.fresh_planes, nullptr);
  std::vector<BlockIndex> changed = std::move(work.dropped);
  UpdateLines<Axis::kZ>(planes, work.fresh_distances, &changed);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

}  // namespace vismap
