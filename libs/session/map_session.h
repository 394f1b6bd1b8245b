#pragma once

#include <set>
#include <string>
#include <utility>

#include "base/result.h"
#include "mapfile/map_file.h"
#include "mapping/integrate.h"

namespace vismap {

// What lives in this room: a map together with what it was made of and by (its identity, trajectory
// and options), and the files that people get from it. The map server and the offline mapper are
// both thin around it, so that they agree.

struct MapSessionOptions {
  VoxelGridOptions grid;
  AssociationOptions association;
  IntegrationOptions integration;
};

/// A map being made. Frames go in once each; the same frames in the same order give the same map.
class MapSession {
 public:
  /// `metadata.map_id` names the map; its trajectory is continued.
  MapSession(const MapSessionOptions& options, MapMetadata metadata);

  /// Continues a saved map. Fails when its voxel grid is not the one of the options.
  static Result<MapSession> Continue(const MapSessionOptions& options, LoadedMap loaded);

  /// Whether this camera's frame of this time is in the map already.
  bool Contains(CameraId camera, int64_t utime) const {
    return taken_.contains({Raw(camera), utime});
  }

  /// First half of taking a frame; changes nothing.
  FrameAssociation Associate(const SegmentedFrame& frame) const;
  /// Second half. Throws when the frame is in the map already.
  MapDelta Integrate(const SegmentedFrame& frame, const FrameAssociation& association);

  const SemanticMap& map() const { return map_; }
  const MapMetadata& metadata() const { return metadata_; }
  const MapSessionOptions& options() const { return options_; }

 private:
  MapSessionOptions options_;
  SemanticMap map_;
  MapMetadata metadata_;
  std::set<std::pair<int32_t, int64_t>> taken_;  // (camera, utime)
};

/// 32 hexadecimal digits over what a frame did: the ids it was given and the new distances and
/// weights of the blocks it changed. Two runs part at the first frame whose digests differ.
std::string DigestFrame(const SemanticMap& map, const FrameAssociation& association,
                        const MapDelta& delta);

}  // namespace vismap
