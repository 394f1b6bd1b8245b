#pragma once

#include <tsl/robin_map.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "map/block.h"
#include "viewer/spill_file.h"

namespace vismap {

/// What a block was from some moment of a growing map on, until its next version.
struct BlockVersion {
  int32_t frames = 0;  ///< of the map at that moment
  uint32_t triangles = 0;
  uint64_t hash = 0;       ///< 0 = the block has nothing
  SpillFile::Place place;  ///< of its bytes
};

/// The versions of all blocks of a map, ascending by moment. A map after so many frames consists of
/// the newest version of each block that is not younger.
class VersionTable {
 public:
  /// `version` must be younger than all others of its block.
  void Add(BlockIndex index, const BlockVersion& version) {
    blocks_[index].push_back(version);
    ++versions_;
  }
  /// nullptr when the block had nothing after so many frames.
  const BlockVersion* At(BlockIndex index, int64_t frames) const {
    const auto found = blocks_.find(index);
    return found == blocks_.end() ? nullptr : Newest(found->second, frames);
  }
  /// Calls `visit(index, version)` for every block that had something after so many frames.
  template <typename Visit>
  void ForEachAt(int64_t frames, const Visit& visit) const {
    for (const auto& [index, versions] : blocks_) {
      if (const BlockVersion* version = Newest(versions, frames)) visit(index, *version);
    }
  }
  /// Forgets versions that belong to none of these moments (numbers of frames, ascending).
  void KeepOnly(std::span<const int64_t> moments);
  /// Adds the places of all versions that have bytes.
  void CollectPlaces(std::vector<SpillFile::Place*>* places);

  size_t versions() const { return versions_; }
  /// Memory [bytes], about.
  size_t bytes() const { return versions_ * sizeof(BlockVersion) + blocks_.size() * 64; }

 private:
  using Versions = std::vector<BlockVersion>;
  static const BlockVersion* Newest(const Versions& versions, int64_t frames) {
    const auto after =
        std::upper_bound(versions.begin(), versions.end(), frames,
                         [](int64_t f, const BlockVersion& version) { return f < version.frames; });
    if (after == versions.begin() || std::prev(after)->hash == 0) return nullptr;
    return &*std::prev(after);
  }

  tsl::robin_map<BlockIndex, Versions, BlockIndexHash> blocks_;
  size_t versions_ = 0;
};

}  // namespace vismap
