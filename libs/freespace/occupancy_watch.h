#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "freespace/occupancy_digest.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Tells which blocks of a growing map changed their occupancy, and when, without a copy of it: of
/// each block it holds a checksum and a revision, 12 bytes where an OccupancyMap holds up to 170.
class OccupancyWatch {
 public:
  explicit OccupancyWatch(const OccupancyOptions& options) : options_(options) {}

  /// Forgets everything.
  void Clear();
  /// Classifies the given blocks of the map again, notes its revision with those that turned out
  /// different, and returns them.
  OccupancyDelta Update(const SemanticMap& map, std::span<const BlockIndex> changed);
  /// Blocks that changed after a revision, ascending.
  std::vector<BlockIndex> ChangedAfter(int64_t revision) const;
  /// Of which anything is known.
  size_t size() const { return digest_.blocks(); }
  /// The same as that of an OccupancyMap with the same content.
  std::string Digest(double cell_size) const { return digest_.Hex(cell_size); }

 private:
  // Of four-byte parts, so that none of the many is padded.
  struct Entry {
    uint32_t revision = 0;  // of its last change
    std::array<uint32_t, 2> checksum{};
  };

  OccupancyOptions options_;
  BlockTable<Entry> entries_;
  OccupancyDigest digest_;
};

}  // namespace vismap
