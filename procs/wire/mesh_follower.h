#pragma once

#include <tsl/robin_map.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "wire/mesh_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Digest of a surface by blocks, as it travels: equal for equal surfaces, whatever way they came
/// about.
class MeshDigest {
 public:
  /// Of the surface of a block; 0 = it has none.
  static uint64_t HashOf(const mesh_block_t& block);
  /// The same, of a block's bytes.
  static uint64_t HashOf(std::span<const uint8_t> encoded_block);
  /// The surface of this block is now the one with that hash.
  void Set(BlockIndex index, uint64_t hash);
  void Clear() { *this = {}; }
  std::string Hex() const;

 private:
  tsl::robin_map<BlockIndex, uint64_t, BlockIndexHash> blocks_;  // hash of each
  uint64_t sum_ = 0;  // of the hashes, so that order cannot matter
};

/// A copy of a map's surface, kept equal to the server's by its MESH_DELTAs: what a viewer holds.
class MeshFollower {
 public:
  /// kBroken when the message contradicts itself; the copy is then as before.
  FollowOutcome Apply(const mesh_delta_t& message);

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  int64_t gaps() const { return sequence_.gaps(); }
  /// How many blocks have a surface, and triangles that has.
  size_t block_count() const { return blocks_.size(); }
  size_t triangle_count() const { return triangles_; }
  std::string Digest() const { return digest_.Hex(); }
  /// All blocks as one mesh, ascending; blocks do not share vertices.
  Mesh Joined() const;

 private:
  // A block as it travels: a third less memory than decoded, and one piece of it.
  struct EncodedBlock {
    size_t triangles = 0;
    std::vector<uint8_t> bytes;
  };
  // Blocks of an update, their bytes behind each other: thousands of pieces of memory that come and
  // go would tear the heap, and a torn heap is slow.
  struct Part {
    struct Block {
      BlockIndex index;
      size_t triangles = 0;
      size_t size = 0;  // in bytes; 0 = it has no surface
    };
    std::vector<Block> blocks;
    std::vector<uint8_t> bytes;
  };
  void Set(const Part::Block& block, std::span<const uint8_t> bytes);

  UpdateSequence<Part> sequence_;
  tsl::robin_map<BlockIndex, EncodedBlock, BlockIndexHash> blocks_;  // with a surface
  size_t triangles_ = 0;
  MeshDigest digest_;
  int64_t utime_ = 0;
};

}  // namespace vismap
