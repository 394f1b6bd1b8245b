#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "freespace/occupancy_digest.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Finds the blocks of a map whose occupancy changes, and remembers at which revision. It holds a
/// checksum and a revision per block, 12 bytes, instead of the up to 170 bytes of an OccupancyMap.
class OccupancyWatch {
 public:
  explicit OccupancyWatch(const OccupancyOptions& options) : options_(options) {}

  /// Removes all blocks.
  void Clear();
  /// Classifies the given blocks of the map, returns those whose occupancy changed, and records the
  /// revision of the map for them.
  OccupancyDelta Update(const SemanticMap& map, std::span<const BlockIndex> changed);
  /// The blocks that changed after a revision, ascending.
  std::vector<BlockIndex> ChangedAfter(int64_t revision) const;
  /// Number of blocks that are not unknown everywhere.
  size_t size() const { return digest_.blocks(); }
  size_t bytes() const { return entries_.bytes(); }  ///< memory, about
  /// The same as that of an OccupancyMap with the same content.
  std::string Digest(double cell_size) const { return digest_.Hex(cell_size); }

 private:
  // Members of four bytes, so that an entry needs no padding.
  struct Entry {
    uint32_t revision = 0;  // of its last change
    std::array<uint32_t, 2> checksum{};
  };

  OccupancyOptions options_;
  BlockTable<Entry> entries_;
  OccupancyDigest digest_;
};

}  // namespace vismap
