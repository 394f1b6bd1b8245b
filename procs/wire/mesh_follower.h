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

/// Digest of a surface, computed from its encoded blocks without `seen`. Equal surfaces have equal
/// digests, independent of the order of the updates that produced them. A block that is only seen
/// once more keeps its digest, and messages of the first version have the same one.
class MeshDigest {
 public:
  /// Hash of the surface of one block; 0 when the block has no surface.
  static uint64_t HashOf(const mesh_block_t& block);
  /// The same for an encoded block with so many vertices, at least one.
  static uint64_t HashOf(std::span<const uint8_t> encoded_block, size_t vertices);
  /// Sets the hash of a block and replaces its old one; 0 removes the block.
  void Set(BlockIndex index, uint64_t hash);
  void Clear() { *this = {}; }
  std::string Hex() const;

 private:
  tsl::robin_map<BlockIndex, uint64_t, BlockIndexHash>
      blocks_;        // hash of each block with a surface
  uint64_t sum_ = 0;  // of all hashes; a sum does not depend on the order
};

/// A copy of the surface of the server's map, built from its MESH_DELTA updates; a viewer holds
/// one. Its memory is bounded, see FollowLimits; a surface that needs more is dropped and reported
/// as kTooLarge.
class MeshFollower {
 public:
  explicit MeshFollower(const FollowLimits& limits = {}) : sequence_(limits) {}

  /// Adds one part of an update at time `now` [s]; the copy changes when the last part has arrived.
  /// Returns kBroken when the message is inconsistent; the copy then stays as it was.
  FollowOutcome Apply(const mesh_delta_t& message, double now = 0);

  /// Drops the parts of an update whose other parts do not come. Returns how many.
  size_t GiveUpStaleParts(double now) { return sequence_.GiveUpStaleParts(now); }
  /// Memory of the copy and of the parts that wait [bytes], about.
  size_t bytes() const { return sequence_.staged_bytes() + copy_bytes(); }

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }           ///< of the newest frame contained [us]
  int64_t gaps() const { return sequence_.gaps(); }  ///< how often an update was missing
  /// Number of blocks that have a surface, and of their triangles.
  size_t block_count() const { return blocks_.size(); }
  size_t triangle_count() const { return triangles_; }
  std::string Digest() const { return digest_.Hex(); }
  /// All blocks joined into one mesh, in ascending order of their index. Blocks do not share
  /// vertices.
  Mesh Joined() const;

 private:
  // A block in its encoded form, which takes a third less memory than a decoded one, in a single
  // allocation.
  struct EncodedBlock {
    size_t triangles = 0;
    std::vector<uint8_t> bytes;
  };
  // Blocks of an update; their encoded bytes are stored one after the other. One allocation per
  // block would fragment the heap, which makes it slow.
  struct Part {
    struct Block {
      BlockIndex index;
      size_t vertices = 0, triangles = 0;
      size_t size = 0;  // [bytes]; 0 = the block has no surface
    };
    std::vector<Block> blocks;
    std::vector<uint8_t> bytes;
  };
  void Set(const Part::Block& block, std::span<const uint8_t> bytes);
  void Clear();
  size_t copy_bytes() const { return held_bytes_ + blocks_.size() * kBytesPerBlock; }
  // Entries of a block in both tables.
  static constexpr size_t kBytesPerBlock = 256;

  UpdateSequence<Part> sequence_;
  tsl::robin_map<BlockIndex, EncodedBlock, BlockIndexHash> blocks_;  // with a surface
  size_t triangles_ = 0;
  size_t held_bytes_ = 0;  // of the encoded blocks
  MeshDigest digest_;
  int64_t utime_ = 0;
};

}  // namespace vismap
