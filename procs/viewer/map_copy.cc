#include "viewer/map_copy.h"

#include <algorithm>
#include <utility>

#include "base/digest.h"
#include "wire/mesh_follower.h"

namespace vismap {

MapCopy::Part MapCopy::Encode(const mesh_delta_t& message, size_t* bytes) {
  Part part;
  for (const mesh_block_t& block : message.blocks) {
    Part::Block encoded{{block.index[0], block.index[1], block.index[2]}, {}};
    if (block.n_vertices > 0) {
      encoded.held.hash = MeshDigest::HashOf(block);
      encoded.held.triangles = static_cast<size_t>(block.n_triangles);
      encoded.held.bytes = std::make_shared<const std::vector<uint8_t>>(
          EncodePageBlock(block, encoded.held.hash, message.revision));
      *bytes += encoded.held.bytes->size();
    }
    *bytes += sizeof(Part::Block);
    part.block_edge_m = static_cast<double>(block.edge_m);
    part.blocks.push_back(std::move(encoded));
  }
  return part;
}

FollowOutcome MapCopy::Apply(const mesh_delta_t& message, double now) {
  if (!Check(message)) return FollowOutcome::kBroken;
  size_t bytes = 0;
  Part part = Encode(message, &bytes);
  const FollowOutcome outcome =
      sequence_.AddPart({message.map_id, message.revision, message.base_revision,
                         static_cast<bool>(message.full), message.part, message.parts},
                        std::move(part), bytes, now);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (!Replace(message, sequence_.ReleaseParts())) {
    Clear();
    sequence_.RequireSnapshot();
    return FollowOutcome::kTooLarge;
  }
  utime_ = message.utime;
  revision_ = message.revision;
  return outcome;
}

// Returns false when the copy takes too much memory.
bool MapCopy::Replace(const mesh_delta_t& head, std::vector<Part> parts) {
  if (head.map_id != map_id_) Clear();
  map_id_ = head.map_id;
  if (head.full) {
    // Blocks of the old state that the snapshot does not have are gone.
    std::vector<BlockIndex> present;
    for (const Part& part : parts) {
      for (const Part::Block& block : part.blocks) present.push_back(block.index);
    }
    std::sort(present.begin(), present.end());
    for (const BlockIndex& index : SortedIndices()) {
      if (!std::binary_search(present.begin(), present.end(), index)) Set({index, {}});
    }
  }
  return SetAll(std::move(parts));
}

bool MapCopy::SetAll(std::vector<Part> parts) {
  for (const Part& part : parts) {
    for (const Part::Block& block : part.blocks) Set(block);
    if (part.block_edge_m > 0) block_edge_m_ = part.block_edge_m;
    if (held_bytes() > sequence_.limits().max_bytes) return false;
  }
  return true;
}

void MapCopy::Set(const Part::Block& block) {
  const auto known = blocks_.find(block.index);
  const uint64_t old_hash = known == blocks_.end() ? 0 : known->second.hash;
  if (old_hash == block.held.hash) return;
  changes_.blocks.push_back(block.index);
  hash_sum_ += block.held.hash - old_hash;
  if (known != blocks_.end()) {
    triangles_ -= known->second.triangles;
    encoded_bytes_ -= known->second.bytes->size();
    blocks_.erase(known);
  }
  if (block.held.bytes == nullptr) return;
  triangles_ += block.held.triangles;
  encoded_bytes_ += block.held.bytes->size();
  blocks_.emplace(block.index, block.held);
}

void MapCopy::Clear() {
  blocks_.clear();
  triangles_ = encoded_bytes_ = 0;
  hash_sum_ = 0;
  block_edge_m_ = 0;
  revision_ = -1;
  changes_ = {true, {}};
}

SurfaceChanges MapCopy::ConsumeChanges() {
  std::sort(changes_.blocks.begin(), changes_.blocks.end());
  changes_.blocks.erase(std::unique(changes_.blocks.begin(), changes_.blocks.end()),
                        changes_.blocks.end());
  return std::exchange(changes_, {});
}

const MapCopy::Held* MapCopy::Find(BlockIndex index) const {
  const auto found = blocks_.find(index);
  return found == blocks_.end() ? nullptr : &found->second;
}

std::vector<BlockIndex> MapCopy::SortedIndices() const {
  std::vector<BlockIndex> indices;
  indices.reserve(blocks_.size());
  for (const auto& entry : blocks_) indices.push_back(entry.first);
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::vector<SurfaceBlock> MapCopy::Blocks() const {
  std::vector<SurfaceBlock> blocks;
  blocks.reserve(blocks_.size());
  for (const auto& entry : blocks_) blocks.push_back({entry.first, entry.second.bytes});
  return blocks;
}

MapSummary MapCopy::Summary() const {
  MapSummary summary;
  summary.map_id = position().map_id;
  summary.revision = revision_;
  summary.utime = utime_;
  summary.blocks = blocks_.size();
  summary.triangles = triangles_;
  summary.digest = hash_sum_;
  Digest digest;  // as MeshDigest::Hex
  digest.Add(static_cast<uint64_t>(blocks_.size()));
  digest.Add(hash_sum_);
  summary.mesh_digest = digest.Hex();
  summary.block_edge_m = block_edge_m_;
  summary.in_sync = in_sync();
  return summary;
}

}  // namespace vismap
