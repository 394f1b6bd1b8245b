#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/mesh_delta_t.hpp>

#include "viewer/object_mask.h"
#include "viewer/surface_view.h"
#include "wire/update_sequence.h"

namespace vismap {

/// A copy of the surface of the server's map, from its MESH_DELTA updates, as the page gets it:
/// each block is encoded once, whatever the number of pages. Like MeshFollower, it detects missing
/// updates and is bounded in memory. A snapshot of the same map changes only the blocks that
/// differ.
class MapCopy : public SurfaceView {
 public:
  struct Held {
    FrameBytes bytes;   ///< see EncodePageBlock
    uint64_t hash = 0;  ///< MeshDigest::HashOf
    size_t triangles = 0;
  };

  explicit MapCopy(const FollowLimits& limits) : sequence_(limits) {}

  /// Adds one part of an update at time `now` [s]; the copy changes when the last part has arrived.
  FollowOutcome Apply(const mesh_delta_t& message, double now);
  /// Drops the parts of an update whose other parts do not come. Returns how many.
  size_t GiveUpStaleParts(double now) { return sequence_.GiveUpStaleParts(now); }

  /// Only a snapshot can be applied next; until it comes, the copy stays as it is.
  void RequireSnapshot() { sequence_.RequireSnapshot(); }

  /// What changed since the last call.
  SurfaceChanges ConsumeChanges();

  /// nullptr when the block has no surface.
  const Held* Find(BlockIndex index) const;
  FrameBytes BytesOf(BlockIndex index) override {
    const Held* held = Find(index);
    return held == nullptr ? nullptr : held->bytes;
  }
  std::vector<BlockIndex> SortedIndices() const override;
  /// All blocks with a surface, in any order.
  std::vector<SurfaceBlock> Blocks() const;
  /// Without age_s and voxel_size_m.
  MapSummary Summary() const;
  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t gaps() const { return sequence_.gaps(); }  ///< how often an update was missing
  double block_edge_m() const override { return block_edge_m_; }
  int64_t revision() const override { return position().revision; }
  /// Memory of the copy and of the parts that wait [bytes], about.
  size_t bytes() const { return sequence_.staged_bytes() + held_bytes(); }

 private:
  struct Part {
    struct Block {
      BlockIndex index;
      Held held;  // without bytes = the block has no surface
    };
    std::vector<Block> blocks;
    double block_edge_m = 0;  // 0 = it has no block
  };
  static Part Encode(const mesh_delta_t& message, size_t* bytes);
  bool Replace(const mesh_delta_t& head, std::vector<Part> parts);
  bool SetAll(std::vector<Part> parts);
  void Set(const Part::Block& block);
  void Clear();
  size_t held_bytes() const { return encoded_bytes_ + blocks_.size() * kBytesPerBlock; }
  static constexpr size_t kBytesPerBlock = 160;  // entries in tables, allocation

  UpdateSequence<Part> sequence_;
  tsl::robin_map<BlockIndex, Held, BlockIndexHash> blocks_;  // with a surface
  std::string map_id_;                                       // of the blocks
  size_t triangles_ = 0, encoded_bytes_ = 0;
  uint64_t hash_sum_ = 0;
  int64_t utime_ = 0, revision_ = -1;  // of the blocks
  double block_edge_m_ = 0;
  SurfaceChanges changes_;
};

}  // namespace vismap
