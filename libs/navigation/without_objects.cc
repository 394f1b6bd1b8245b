#include "navigation/without_objects.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "navigation/inflate.h"
#include "navigation/object_surroundings.h"

namespace vismap {
namespace {

// An object that is seen this far behind a plane passes through it and is not supported by it.
constexpr float kPassesThrough = -3;
constexpr float kDeepest = 6;  // behind a plane that the truncation distance reaches, and a little
// Votes for a support that are farther than this above it, and as near to the object, are mistaken.
constexpr float kAboveSupport = 0.25F, kMostAbove = 5;
constexpr int kMistakenReach = 2;
// The whole box of an object is looked at for enclosed space up to this size [blocks].
constexpr double kLargestBox = 8192;

bool Bit(const VoxelBits& bits, NearVoxel voxel) {
  const auto offset = static_cast<size_t>(voxel) % kBlockVoxels;
  return ((bits[offset / 64] >> (offset % 64)) & 1) != 0;
}

void SetBit(NearVoxel voxel, VoxelBits* bits) {
  const auto offset = static_cast<size_t>(voxel) % kBlockVoxels;
  (*bits)[offset / 64] |= uint64_t{1} << (offset % 64);
}

int64_t Count(const VoxelBits& bits) {
  int64_t count = 0;
  for (const uint64_t word : bits) count += std::popcount(word);
  return count;
}

/// What the voxels of a block become.
struct Fate {
  VoxelBits free{}, unknown{};
};

/// Decides what becomes of the voxels of objects that are near each other when they are taken away.
class Removal {
 public:
  Removal(std::vector<SurroundingBlock> blocks, const OccupancyOptions& options)
      : near_(std::move(blocks)), fates_(near_.blocks().size()), options_(options) {
    near_.SpreadSurfaces();
    FindPlanes();
    FindBox();
    TakeMistakenVotes();
  }

  /// The fates of blocks(), in their order.
  const std::vector<Fate>& Decide() {
    near_.ForObject([this](NearVoxel voxel) { DecideVoxel(voxel); });
    FreeEnclosed();
    return fates_;
  }

  const std::vector<SurroundingBlock>& blocks() const { return near_.blocks(); }

 private:
  void FindPlanes();
  void FindBox();
  void TakeMistakenVotes();
  bool IsMistaken(NearVoxel voxel) const;
  void DecideVoxel(NearVoxel voxel);
  void FreeEnclosed();
  float HeightAbovePlanes(NearVoxel voxel, const SupportPlane** nearest = nullptr) const;
  bool HasVoteBeside(NearVoxel voxel, uint8_t surface) const;
  bool TouchesOther(NearVoxel voxel) const;
  bool CanBeEnclosed(NearVoxel voxel) const;
  bool IsInBox(NearVoxel voxel) const;
  bool Flood(NearVoxel seed, std::vector<NearVoxel>* reached);
  Fate& FateOf(NearVoxel voxel) { return fates_[static_cast<size_t>(voxel) / kBlockVoxels]; }

  NearSpace near_;
  std::vector<Fate> fates_;
  OccupancyOptions options_;
  std::vector<SupportPlane> planes_;
  VoxelIndex low_{}, high_{};             // corners of the box of voxels that vote for the objects
  std::vector<VoxelBits> looked_, open_;  // voxels that Flood has reached; that are not enclosed
};

void Removal::FindPlanes() {
  std::vector<SurfaceSample> samples;
  for (const SurroundingBlock& block : near_.blocks())
    samples.insert(samples.end(), block.samples.begin(), block.samples.end());
  planes_ = FindSupportPlanes(samples);
}

void Removal::FindBox() {
  constexpr int32_t kFar = std::numeric_limits<int32_t>::max();
  low_ = {kFar, kFar, kFar};
  high_ = {-kFar, -kFar, -kFar};
  near_.ForObject([&](NearVoxel voxel) {
    if (!near_.Voted(voxel)) return;
    const VoxelIndex at = near_.IndexOf(voxel);
    low_ = {std::min(low_.x, at.x), std::min(low_.y, at.y), std::min(low_.z, at.z)};
    high_ = {std::max(high_.x, at.x), std::max(high_.y, at.y), std::max(high_.z, at.z)};
  });
}

bool Removal::IsInBox(NearVoxel voxel) const {
  const VoxelIndex at = near_.IndexOf(voxel);
  return at.x >= low_.x && at.y >= low_.y && at.z >= low_.z && at.x <= high_.x && at.y <= high_.y &&
         at.z <= high_.z;
}

// Where an object stands on its support, votes for the support reach up the object.
void Removal::TakeMistakenVotes() {
  constexpr int kReach = kMistakenReach, kEdge = 2 * kReach + 1;
  std::vector<NearVoxel> mistaken;
  near_.ForObject([&](NearVoxel voxel) {
    const float height = HeightAbovePlanes(voxel);
    if (height < -kReach || height > kMostAbove + kReach) return;
    for (int slot = 0; slot < kEdge * kEdge * kEdge; ++slot) {
      const NearVoxel beside =
          near_.Beside(voxel, slot % kEdge - kReach, slot / kEdge % kEdge - kReach,
                       slot / (kEdge * kEdge) - kReach);
      if (beside >= 0 && near_.Surface(beside) > kObjectSurface && IsMistaken(beside))
        mistaken.push_back(beside);
    }
  });
  for (const NearVoxel voxel : mistaken) near_.Surface(voxel) = kObjectSurface;
}

bool Removal::IsMistaken(NearVoxel voxel) const {
  const auto least = static_cast<float>(near_.IsOccupied(voxel) ? options_.occupied_max_voxels
                                                                : options_.free_min_voxels);
  const Eigen::Vector3f at = near_.PlaceOf(voxel);
  return std::any_of(planes_.begin(), planes_.end(), [&](const SupportPlane& plane) {
    if (plane.surface != near_.Surface(voxel) || !plane.Covers(at)) return false;
    const float height = plane.HeightOf(at);
    return height > least + kAboveSupport && height < kMostAbove;
  });
}

/// The height above the plane that supports the voxel most closely; large without one.
float Removal::HeightAbovePlanes(NearVoxel voxel, const SupportPlane** nearest) const {
  const Eigen::Vector3f at = near_.PlaceOf(voxel);
  float least = std::numeric_limits<float>::max();
  for (const SupportPlane& plane : planes_) {
    const float height = plane.HeightOf(at);
    if (height >= least || height < -2 * kBlockSide) continue;
    if (near_.Voted(voxel) && height < kPassesThrough) continue;
    // What lies behind an object, and never was seen, may lie in the plane beyond its samples, too.
    const bool may_be_hidden = !near_.Voted(voxel) && height > -kDeepest;
    if (!may_be_hidden && !plane.Covers(at)) continue;
    least = height;
    if (nearest != nullptr) *nearest = &plane;
  }
  return least;
}

bool Removal::HasVoteBeside(NearVoxel voxel, uint8_t surface) const {
  for (int slot = 0; slot < 27; ++slot) {
    const NearVoxel beside = near_.Beside(voxel, slot % 3 - 1, slot / 3 % 3 - 1, slot / 9 - 1);
    if (beside >= 0 && near_.Surface(beside) == surface && near_.Voted(beside)) return true;
  }
  return false;
}

bool Removal::TouchesOther(NearVoxel voxel) const {
  bool touches = false;
  near_.ForSides(voxel, [&](NearVoxel beside) {
    touches = touches || (beside >= 0 && near_.Surface(beside) > kObjectSurface);
  });
  return touches;
}

void Removal::DecideVoxel(NearVoxel voxel) {
  if (near_.IsFree(voxel)) return;
  const SupportPlane* support = nullptr;
  const double height = HeightAbovePlanes(voxel, &support);
  const bool in_support = height <= options_.occupied_max_voxels;
  if (in_support && near_.IsOccupied(voxel) && HasVoteBeside(voxel, support->surface)) return;
  const bool hidden =
      height < options_.free_min_voxels || (!near_.Voted(voxel) && TouchesOther(voxel));
  SetBit(voxel, hidden ? &FateOf(voxel).unknown : &FateOf(voxel).free);
}

// Unseen space that may be the inside of an object.
bool Removal::CanBeEnclosed(NearVoxel voxel) const {
  return near_.IsUnseen(voxel) && HeightAbovePlanes(voxel) >= options_.free_min_voxels;
}

/// Reaches all space around `seed` that may be enclosed. Returns false when that space goes on
/// outside of the objects' box; not all of it is reached then.
bool Removal::Flood(NearVoxel seed, std::vector<NearVoxel>* reached) {
  const auto of = [](std::vector<VoxelBits>& bits, NearVoxel voxel) -> VoxelBits& {
    return bits[static_cast<size_t>(voxel) / kBlockVoxels];
  };
  reached->assign(1, seed);
  SetBit(seed, &of(looked_, seed));
  bool closed = IsInBox(seed);
  for (size_t i = 0; i < reached->size() && closed; ++i) {
    near_.ForSides((*reached)[i], [&](NearVoxel beside) {
      if (beside >= 0 && !CanBeEnclosed(beside)) return;
      closed = closed && beside >= 0 && IsInBox(beside) && !Bit(of(open_, beside), beside);
      if (!closed || Bit(of(looked_, beside), beside)) return;
      SetBit(beside, &of(looked_, beside));
      reached->push_back(beside);
    });
  }
  if (closed) return true;
  for (const NearVoxel voxel : *reached) SetBit(voxel, &of(open_, voxel));
  return false;
}

void Removal::FreeEnclosed() {
  looked_.assign(fates_.size(), {});
  open_ = looked_;
  std::vector<NearVoxel> reached;
  near_.ForObject([&](NearVoxel voxel) {
    if (!Bit(FateOf(voxel).free, voxel)) return;
    near_.ForSides(voxel, [&](NearVoxel beside) {
      if (beside < 0 || !near_.IsUnseen(beside)) return;
      if (Bit(looked_[static_cast<size_t>(beside) / kBlockVoxels], beside)) return;
      if (!CanBeEnclosed(beside) || !Flood(beside, &reached)) return;
      for (const NearVoxel inside : reached) SetBit(inside, &FateOf(inside).free);
    });
  });
}

/// The blocks of a list in groups: blocks of different groups are at least three blocks apart.
std::vector<std::vector<BlockIndex>> Groups(const std::vector<BlockIndex>& blocks) {
  BlockTable<uint8_t> left;
  for (const BlockIndex& block : blocks) left.FindOrCreate(block) = 1;
  std::vector<std::vector<BlockIndex>> groups;
  for (const BlockIndex& first : blocks) {
    if (*left.Find(first) == 0) continue;
    *left.Find(first) = 0;
    std::vector<BlockIndex>& group = groups.emplace_back(1, first);
    for (size_t i = 0; i < group.size(); ++i) {
      for (int slot = 0; slot < 125; ++slot) {
        const BlockIndex beside{group[i].x + slot % 5 - 2, group[i].y + slot / 5 % 5 - 2,
                                group[i].z + slot / 25 - 2};
        uint8_t* is_left = left.Find(beside);
        if (is_left == nullptr || *is_left == 0) continue;
        *is_left = 0;
        group.push_back(beside);
      }
    }
  }
  return groups;
}

/// The blocks of a group, those around them, and, unless that is too large, all of their box.
std::vector<BlockIndex> Around(const std::vector<BlockIndex>& group) {
  std::vector<BlockIndex> blocks;
  BlockIndex low = group.front(), high = group.front();
  for (const BlockIndex& block : group) {
    low = {std::min(low.x, block.x), std::min(low.y, block.y), std::min(low.z, block.z)};
    high = {std::max(high.x, block.x), std::max(high.y, block.y), std::max(high.z, block.z)};
    for (int slot = 0; slot < 27; ++slot) {
      blocks.push_back(
          {block.x + slot % 3 - 1, block.y + slot / 3 % 3 - 1, block.z + slot / 9 - 1});
    }
  }
  const double size =
      double{1} * (high.x - low.x + 1) * (high.y - low.y + 1) * (high.z - low.z + 1);
  for (BlockIndex at = low; size <= kLargestBox && at.x <= high.x; ++at.x) {
    for (at.y = low.y; at.y <= high.y; ++at.y) {
      for (at.z = low.z; at.z <= high.z; ++at.z) blocks.push_back(at);
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

/// The plain occupancy of all blocks that an edit has looked at, and what they became.
class Editor {
 public:
  Editor(const SemanticMap& map, const OccupancyOptions& options) : map_(map), options_(options) {}

  void Remove(const ObjectEdit& edit);
  Result<void> Inflate(const ObjectEdit& edit);
  EditedSpace Finish() const;

 private:
  struct Entry {
    BlockOccupancy plain, now;
  };
  using Read = std::map<BlockIndex, SurroundingBlock>;

  Entry& At(BlockIndex index);
  std::vector<BlockIndex> ReadObjects(const ObjectEdit& edit, SurroundingsReader* reader,
                                      Read* read) const;
  void Apply(const SurroundingBlock& block, const Fate& fate, ObjectAction action);

  const SemanticMap& map_;
  OccupancyOptions options_;
  std::map<BlockIndex, Entry> entries_;
};

Editor::Entry& Editor::At(BlockIndex index) {
  const auto [found, is_new] = entries_.try_emplace(index);
  if (is_new) {
    if (const Block* block = map_.voxels.Find(index))
      found->second.plain = ClassifyBlock(*block, map_.voxels.options(), options_);
    found->second.now = found->second.plain;
  }
  return found->second;
}

/// The blocks with voxels that vote for the objects, ascending.
std::vector<BlockIndex> Editor::ReadObjects(const ObjectEdit& edit, SurroundingsReader* reader,
                                            Read* read) const {
  std::vector<BlockIndex> blocks = edit.blocks;
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  for (const BlockIndex& index : blocks) read->emplace(index, reader->Read(index));
  std::erase_if(blocks, [&](const BlockIndex& index) { return !read->at(index).has_object; });
  return blocks;
}

void Editor::Apply(const SurroundingBlock& block, const Fate& fate, ObjectAction action) {
  if (Count(fate.free) + Count(fate.unknown) == 0) return;
  const BlockOccupancy plain(block.plain);
  Entry& entry = entries_.try_emplace(block.index, Entry{plain, plain}).first->second;
  OccupancyPlanes planes = entry.now.Planes();
  for (size_t i = 0; i < planes.free.size(); ++i) {
    planes.occupied[i] &= ~(fate.free[i] | fate.unknown[i]);
    planes.free[i] &= ~fate.unknown[i];
    if (action == ObjectAction::kLeaveOut) planes.free[i] |= fate.free[i];
  }
  entry.now = BlockOccupancy(planes);
}

void Editor::Remove(const ObjectEdit& edit) {
  SurroundingsReader reader(map_, edit.labels, options_);
  Read read;
  for (const std::vector<BlockIndex>& group : Groups(ReadObjects(edit, &reader, &read))) {
    std::vector<SurroundingBlock> blocks;
    for (const BlockIndex& index : Around(group)) {
      const auto found = read.find(index);
      blocks.push_back(found == read.end() ? reader.Read(index) : std::move(found->second));
    }
    Removal removal(std::move(blocks), options_);
    const std::vector<Fate>& fates = removal.Decide();
    for (size_t i = 0; i < fates.size(); ++i) Apply(removal.blocks()[i], fates[i], edit.action);
  }
}

Result<void> Editor::Inflate(const ObjectEdit& edit) {
  const double voxel = map_.voxels.voxel_size();
  if (!(edit.inflate_m >= 0 && edit.inflate_m <= kMostInflatedVoxels * voxel)) {
    return Fail("inflate: expected from 0 to " + std::to_string(kMostInflatedVoxels * voxel) +
                " m, found " + std::to_string(edit.inflate_m) + " m");
  }
  SurroundingsReader reader(map_, edit.labels, options_);
  Read read;
  OccupancyMap objects(voxel);
  std::vector<SurroundingBlock> blocks;
  for (const BlockIndex& index : ReadObjects(edit, &reader, &read))
    blocks.push_back(std::move(read.at(index)));
  NearSpace space(std::move(blocks));
  space.SpreadSurfaces();
  std::vector<OccupancyPlanes> planes(space.blocks().size());
  space.ForObject([&](NearVoxel at) {
    if (space.IsOccupied(at)) SetBit(at, &planes[static_cast<size_t>(at) / kBlockVoxels].occupied);
  });
  for (size_t i = 0; i < planes.size(); ++i)
    objects.Set(space.blocks()[i].index, BlockOccupancy(planes[i]));
  const Result<OccupancyMap> larger =
      vismap::Inflate(objects, {edit.inflate_m, UnknownPolicy::kAbsent});
  if (!larger) return tl::unexpected(larger.error());
  for (const BlockIndex& index : larger->SortedIndices()) {
    Entry& entry = At(index);
    OccupancyPlanes now = entry.now.Planes();
    const OccupancyPlanes more = larger->At(index).Planes();
    for (size_t i = 0; i < now.free.size(); ++i) {
      now.occupied[i] |= more.occupied[i];
      now.free[i] &= ~more.occupied[i];
    }
    entry.now = BlockOccupancy(now);
  }
  return {};
}

EditedSpace Editor::Finish() const {
  EditedSpace space;
  space.delta.voxel_size = map_.voxels.voxel_size();
  for (const auto& [index, entry] : entries_) {
    if (entry.now == entry.plain) continue;
    space.delta.blocks.emplace_back(index, entry.now);
    const OccupancyPlanes now = entry.now.Planes(), before = entry.plain.Planes();
    for (size_t i = 0; i < now.free.size(); ++i) {
      const uint64_t known = before.free[i] | before.occupied[i];
      space.freed += std::popcount(now.free[i] & ~before.free[i]);
      space.made_occupied += std::popcount(now.occupied[i] & ~before.occupied[i]);
      space.made_unknown += std::popcount(known & ~(now.free[i] | now.occupied[i]));
    }
  }
  return space;
}

}  // namespace

Result<EditedSpace> EditObjects(const SemanticMap& map, std::span<const ObjectEdit> edits,
                                const OccupancyOptions& options) {
  Editor editor(map, options);
  for (const ObjectAction action :
       {ObjectAction::kLeaveOut, ObjectAction::kMakeUnknown, ObjectAction::kInflate}) {
    for (const ObjectEdit& edit : edits) {
      if (edit.action != action) continue;
      if (action != ObjectAction::kInflate) {
        editor.Remove(edit);
        continue;
      }
      if (const Result<void> done = editor.Inflate(edit); !done)
        return tl::unexpected(done.error());
    }
  }
  return editor.Finish();
}

}  // namespace vismap
