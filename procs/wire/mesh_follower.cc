#include "wire/mesh_follower.h"

#include <algorithm>
#include <vector>

#include "base/digest.h"

namespace vismap {

namespace {

std::vector<uint8_t> BytesOf(const mesh_block_t& block) {
  std::vector<uint8_t> bytes(static_cast<size_t>(block.getEncodedSize()));
  block.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

uint64_t MeshDigest::HashOf(const mesh_block_t& block) {
  return block.n_vertices == 0 ? 0 : HashOf(BytesOf(block));
}

uint64_t MeshDigest::HashOf(std::span<const uint8_t> encoded_block) {
  return std::max<uint64_t>(1, Checksum64(encoded_block));
}

void MeshDigest::Set(BlockIndex index, uint64_t hash) {
  if (const auto known = blocks_.find(index); known != blocks_.end()) {
    sum_ -= known->second;
    blocks_.erase(known);
  }
  if (hash == 0) return;
  blocks_.emplace(index, hash);
  sum_ += hash;
}

std::string MeshDigest::Hex() const {
  vismap::Digest digest;
  digest.Add(static_cast<uint64_t>(blocks_.size()));
  digest.Add(sum_);
  return digest.Hex();
}

FollowOutcome MeshFollower::Take(const mesh_delta_t& message) {
  if (!Decode(message)) return FollowOutcome::kBroken;
  Part received;
  received.blocks.reserve(message.blocks.size());
  for (const mesh_block_t& block : message.blocks) {
    received.blocks.push_back({{block.index[0], block.index[1], block.index[2]},
                               static_cast<size_t>(block.n_triangles),
                               block.n_vertices == 0 ? std::vector<uint8_t>() : BytesOf(block)});
  }
  const FollowOutcome outcome =
      sequence_.Take({message.map_id, message.revision, message.base_revision,
                      static_cast<bool>(message.full), message.part, message.parts},
                     std::move(received));
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (message.full) {
    blocks_.clear();
    triangles_ = 0;
    digest_.Clear();
  }
  for (const Part& part : sequence_.TakeReady()) {
    for (const EncodedBlock& block : part.blocks) Set(block);
  }
  utime_ = message.utime;
  return outcome;
}

void MeshFollower::Set(const EncodedBlock& block) {
  digest_.Set(block.index, block.bytes.empty() ? 0 : MeshDigest::HashOf(block.bytes));
  const auto known = blocks_.find(block.index);
  if (known != blocks_.end()) triangles_ -= known->second.triangles;
  if (block.bytes.empty()) {
    if (known != blocks_.end()) blocks_.erase(known);
    return;
  }
  triangles_ += block.triangles;
  if (known == blocks_.end()) {
    blocks_.emplace(block.index, block);
    return;
  }
  // Into the memory that it has: blocks change often, and a large heap full of gaps is slow.
  EncodedBlock& held = known.value();
  held.triangles = block.triangles;
  held.bytes.assign(block.bytes.begin(), block.bytes.end());
}

Mesh MeshFollower::Joined() const {
  std::vector<BlockIndex> ascending;
  for (const auto& entry : blocks_) ascending.push_back(entry.first);
  std::sort(ascending.begin(), ascending.end());
  Mesh joined;
  for (const BlockIndex& index : ascending) {
    const std::vector<uint8_t>& bytes = blocks_.at(index).bytes;
    mesh_block_t message;
    message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
    const Mesh mesh = Decode(message)->mesh;  // it was decoded once before
    const auto first = static_cast<uint32_t>(joined.vertices.size());
    joined.vertices.insert(joined.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& triangle : mesh.triangles) {
      joined.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
  }
  return joined;
}

}  // namespace vismap
