#include "wire/mesh_follower.h"

#include <algorithm>
#include <vector>
#include <vismap/mesh_block_v1_t.hpp>

#include "base/digest.h"
#include "wire/envelope.h"

namespace vismap {

uint64_t MeshDigest::HashOf(const mesh_block_t& block) {
  if (block.n_vertices == 0) return 0;
  std::vector<uint8_t> bytes(static_cast<size_t>(block.getEncodedSize()));
  block.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return HashOf(bytes, static_cast<size_t>(block.n_vertices));
}

// `seen` stands last; without it a block is one of the first version, but for its fingerprint.
uint64_t MeshDigest::HashOf(std::span<const uint8_t> encoded_block, size_t vertices) {
  const auto hashed = encoded_block.first(encoded_block.size() - vertices);
  std::vector<uint8_t> bytes(hashed.begin(), hashed.end());
  envelope::WriteBigEndian(mesh_block_v1_t::getHash(), bytes.data());
  return std::max<uint64_t>(1, Checksum64(bytes));
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

FollowOutcome MeshFollower::Apply(const mesh_delta_t& message, double now) {
  if (!Check(message)) return FollowOutcome::kBroken;
  Part received;
  size_t bytes = 0;
  for (const mesh_block_t& block : message.blocks) {
    const auto size = static_cast<size_t>(block.n_vertices == 0 ? 0 : block.getEncodedSize());
    received.blocks.push_back({{block.index[0], block.index[1], block.index[2]},
                               static_cast<size_t>(block.n_vertices),
                               static_cast<size_t>(block.n_triangles),
                               size});
    bytes += size;
  }
  received.bytes.resize(bytes);
  uint8_t* to = received.bytes.data();
  for (size_t i = 0; i < received.blocks.size(); ++i) {
    const size_t size = received.blocks[i].size;
    if (size > 0) message.blocks[i].encode(to, 0, static_cast<int>(size));
    to += size;
  }
  const size_t part_bytes = bytes + received.blocks.size() * sizeof(Part::Block);
  const FollowOutcome outcome =
      sequence_.AddPart({message.map_id, message.revision, message.base_revision,
                         static_cast<bool>(message.full), message.part, message.parts},
                        std::move(received), part_bytes, now);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (message.full) Clear();
  for (const Part& part : sequence_.ReleaseParts()) {
    std::span<const uint8_t> left = part.bytes;
    for (const Part::Block& block : part.blocks) {
      Set(block, left.first(block.size));
      left = left.subspan(block.size);
    }
    if (copy_bytes() > sequence_.limits().max_bytes) {
      Clear();
      sequence_.RequireSnapshot();
      return FollowOutcome::kTooLarge;
    }
  }
  utime_ = message.utime;
  return outcome;
}

void MeshFollower::Clear() {
  blocks_.clear();
  triangles_ = held_bytes_ = 0;
  digest_.Clear();
}

void MeshFollower::Set(const Part::Block& block, std::span<const uint8_t> bytes) {
  digest_.Set(block.index, bytes.empty() ? 0 : MeshDigest::HashOf(bytes, block.vertices));
  if (bytes.empty()) {
    const auto known = blocks_.find(block.index);
    if (known == blocks_.end()) return;
    triangles_ -= known->second.triangles;
    held_bytes_ -= known->second.bytes.capacity();
    blocks_.erase(known);
    return;
  }
  EncodedBlock& held = blocks_[block.index];
  triangles_ += block.triangles - held.triangles;
  held.triangles = block.triangles;
  // Reserve in steps: a block changes often, and its size changes little.
  constexpr size_t kStep = 512;
  held_bytes_ -= held.bytes.capacity();
  if (held.bytes.capacity() < bytes.size())
    held.bytes.reserve((bytes.size() + kStep - 1) / kStep * kStep);
  held.bytes.assign(bytes.begin(), bytes.end());
  held_bytes_ += held.bytes.capacity();
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
    const Mesh mesh = Decode(message)->mesh;  // Apply has checked it
    const auto first = static_cast<uint32_t>(joined.vertices.size());
    joined.vertices.insert(joined.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& triangle : mesh.triangles) {
      joined.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
  }
  return joined;
}

}  // namespace vismap
