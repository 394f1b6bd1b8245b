#include "wire/mesh_follower.h"

#include <algorithm>
#include <vector>

#include "base/digest.h"

namespace vismap {

uint64_t MeshDigest::HashOf(const mesh_block_t& block) {
  if (block.n_vertices == 0) return 0;
  std::vector<uint8_t> bytes(static_cast<size_t>(block.getEncodedSize()));
  block.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
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

FollowOutcome MeshFollower::Take(const mesh_delta_t& message) {
  Result<MeshUpdate> update = Decode(message);
  if (!update) return FollowOutcome::kBroken;
  Part received{std::move(update->mesh.blocks), {}};
  for (const mesh_block_t& block : message.blocks)
    received.hashes.push_back(MeshDigest::HashOf(block));
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
  for (Part& part : sequence_.TakeReady()) {
    for (size_t i = 0; i < part.blocks.size(); ++i) {
      digest_.Set(part.blocks[i].block, part.hashes[i]);
      Set(std::move(part.blocks[i]));
    }
  }
  utime_ = message.utime;
  return outcome;
}

void MeshFollower::Set(BlockMesh block) {
  const auto known = blocks_.find(block.block);
  if (known != blocks_.end()) triangles_ -= known->second.triangles.size();
  if (!block.mesh.vertices.empty()) {
    triangles_ += block.mesh.triangles.size();
    blocks_.insert_or_assign(block.block, std::move(block.mesh));
  } else if (known != blocks_.end()) {
    blocks_.erase(known);
  }
}

Mesh MeshFollower::Joined() const {
  std::vector<BlockIndex> ascending;
  for (const auto& entry : blocks_) ascending.push_back(entry.first);
  std::sort(ascending.begin(), ascending.end());
  Mesh joined;
  for (const BlockIndex& index : ascending) {
    const Mesh& mesh = blocks_.at(index);
    const auto first = static_cast<uint32_t>(joined.vertices.size());
    joined.vertices.insert(joined.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& triangle : mesh.triangles) {
      joined.triangles.push_back({triangle[0] + first, triangle[1] + first, triangle[2] + first});
    }
  }
  return joined;
}

}  // namespace vismap
