#include "session/map_session.h"

#include "base/digest.h"
#include "base/require.h"
#include "map/surface_reader.h"

namespace vismap {

MapSession::MapSession(const MapSessionOptions& options, MapMetadata metadata)
    : options_(options), map_(options.grid), metadata_(std::move(metadata)) {
  for (const CameraPose& pose : metadata_.trajectory)
    integrated_.insert({Raw(pose.camera_id), pose.utime});
}

Result<MapSession> MapSession::Continue(const MapSessionOptions& options, LoadedMap loaded) {
  const VoxelGridOptions& grid = loaded.map.voxels.options();
  if (grid.voxel_size_m != options.grid.voxel_size_m ||
      grid.truncation_voxels != options.grid.truncation_voxels) {
    return Fail("the saved map has voxels of " + std::to_string(grid.voxel_size_m) +
                " m and a truncation of " + std::to_string(grid.truncation_voxels) +
                " voxels; the options say " + std::to_string(options.grid.voxel_size_m) +
                " m and " + std::to_string(options.grid.truncation_voxels));
  }
  MapSession session(options, std::move(loaded.metadata));
  session.map_ = std::move(loaded.map);
  return session;
}

FrameAssociation MapSession::Associate(const SegmentedFrame& frame) const {
  return vismap::Associate(frame, {map_.voxels, map_.labels}, options_.association);
}

MapDelta MapSession::Integrate(const SegmentedFrame& frame, const FrameAssociation& association) {
  const FrameHeader& header = frame.frame.header;
  Require(!Contains(header.camera_id, header.utime), "a frame is integrated once");
  MapDelta delta = IntegrateFrame(frame, association, options_.integration, &map_);
  if (!delta.refused.empty()) return delta;
  integrated_.insert({Raw(header.camera_id), header.utime});
  metadata_.trajectory.push_back({header.utime, header.camera_id, header.T_W_C});
  return delta;
}

std::string DigestFrame(const SemanticMap& map, const FrameAssociation& association,
                        const MapDelta& delta) {
  Digest digest;
  digest.Add(delta.revision);
  digest.Add(delta.voxels_updated);
  digest.Add(delta.votes_evicted);
  for (const FrameAssociation::Segment& segment : association.segments) {
    digest.Add(segment.label);
    digest.Add(segment.instance);
  }
  for (const auto& [dead, survivor] : delta.merged) {
    digest.Add(dead);
    digest.Add(survivor);
  }
  SurfaceReader reader;
  for (const BlockIndex& index : delta.changed_blocks) {
    digest.AddBytes(&index, sizeof(index));
    const Block* block = map.voxels.Find(index);
    const SurfaceVoxels* voxels = block != nullptr ? reader.Read(*block) : nullptr;
    if (voxels == nullptr) continue;
    digest.AddBytes(voxels->distance.data(), sizeof(voxels->distance));
    digest.AddBytes(voxels->weight.data(), sizeof(voxels->weight));
    reader.Trim();
  }
  return digest.Hex();
}

}  // namespace vismap
