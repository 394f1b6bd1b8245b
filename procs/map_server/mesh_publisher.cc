#include "map_server/mesh_publisher.h"

#include <utility>

#include "wire/mesh_follower.h"
#include "wire/mesh_update.h"

namespace vismap {
namespace {

mesh_delta_t MessageOf(const SemanticMap& map, const std::string& map_id, MeshPart part) {
  MeshUpdate update;
  update.utime = map.last_utime;
  update.map_id = map_id;
  update.base_revision = part.base_revision;
  update.full = part.base_revision < 0;
  update.part = static_cast<int32_t>(part.part);
  update.parts = static_cast<int32_t>(part.parts);
  update.block_size = map.voxels.block_size();
  update.mesh = {part.revision, std::move(part.blocks)};
  return Encode(update);
}

}  // namespace

void MeshPublisher::Start(const SemanticMap& map, const std::string& map_id) {
  map_id_ = map_id;
  tracker_.Start(map);
}

void MeshPublisher::AddChanges(const SemanticMap& map, const MapDelta& delta) {
  tracker_.AddChanges(map, delta.changes(), delta.merged);
}

void MeshPublisher::PublishChanges(const SemanticMap& map) {
  tracker_.MeshChanges(map, [&](MeshPart part) { SendPart(map, std::move(part)); });
}

void MeshPublisher::PublishAll(const SemanticMap& map) {
  tracker_.MeshAll(map, [&](MeshPart part) { SendPart(map, std::move(part)); });
}

void MeshPublisher::PublishSince(const SemanticMap& map, const FollowerPosition& position) {
  MakeMessages(GapSince(map, position), map, map_id_, options_,
               [this](mesh_delta_t message) { Send(std::move(message)); });
}

void MeshPublisher::PublishNewer(const SemanticMap& map, const FollowerPosition& position) {
  if (position.map_id == map_id_ && position.revision < tracker_.revision())
    PublishSince(map, position);
}

MeshGap MeshPublisher::GapSince(const SemanticMap& map, const FollowerPosition& position) {
  const int64_t revision = position.map_id == map_id_ ? position.revision : -1;
  return tracker_.GapSince(map, revision, [&](MeshPart part) { SendPart(map, std::move(part)); });
}

void MeshPublisher::MakeMessages(const MeshGap& gap, const SemanticMap& map,
                                 const std::string& map_id, const MeshingOptions& options,
                                 const std::function<void(mesh_delta_t)>& receive) {
  MeshBlocksOf(gap, map, options,
               [&](MeshPart part) { receive(MessageOf(map, map_id, std::move(part))); });
}

void MeshPublisher::Heartbeat(const SemanticMap& map) {
  if (tracker_.revision() < 0 || has_changes()) return;
  if (!heartbeat_pacer_.due()) return;
  SendPart(map, {tracker_.revision(), tracker_.revision(), 0, 1, {}});
}

void MeshPublisher::SendPart(const SemanticMap& map, MeshPart part) {
  Send(MessageOf(map, map_id_, std::move(part)));
}

void MeshPublisher::Send(mesh_delta_t message) {
  if (message.map_id != map_id_) return;
  bus_->Publish(kMeshDeltaChannel, std::move(message));
  heartbeat_pacer_.Restart();
}

std::string MeshPublisher::DigestOf(const SemanticMap& map, const MeshingOptions& options) {
  MeshDigest digest;
  MeshWholeMap(map, options, [&](std::vector<BlockMesh> meshes) {
    MeshUpdate update;
    update.full = true;
    update.block_size = map.voxels.block_size();
    update.mesh.blocks = std::move(meshes);
    for (const mesh_block_t& block : Encode(update).blocks)
      digest.Set({block.index[0], block.index[1], block.index[2]}, MeshDigest::HashOf(block));
  });
  return digest.Hex();
}

}  // namespace vismap
