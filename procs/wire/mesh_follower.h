#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "wire/mesh_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Digest of a surface by blocks, as it travels: equal for equal surfaces, whatever way they came
/// about.
class MeshDigest {
 public:
  /// The surface of this block is now that; without vertices it is gone.
  void Set(const mesh_block_t& block);
  void Clear() { *this = {}; }
  std::string Hex() const;

 private:
  std::map<BlockIndex, uint64_t> blocks_;  // hash of each
  uint64_t sum_ = 0;                       // of the hashes, so that order cannot matter
};

/// A copy of a map's surface, kept equal to the server's by its MESH_DELTAs: what a viewer holds.
class MeshFollower {
 public:
  /// kBroken when the message contradicts itself; the copy is then as before.
  FollowOutcome Take(const mesh_delta_t& message);

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  int64_t gaps() const { return sequence_.gaps(); }
  /// Blocks with a surface.
  const std::map<BlockIndex, Mesh>& blocks() const { return blocks_; }
  std::string Digest() const { return digest_.Hex(); }
  /// All blocks as one mesh; blocks do not share vertices.
  Mesh Joined() const;

 private:
  UpdateSequence<mesh_delta_t> sequence_;
  std::map<BlockIndex, Mesh> blocks_;
  MeshDigest digest_;
  int64_t utime_ = 0;
};

}  // namespace vismap
