#pragma once

#include <set>
#include <string>
#include <utility>

#include "base/result.h"
#include "geometry/prepare_depth.h"
#include "mapfile/map_file.h"
#include "mapping/integrate.h"

namespace vismap {

// What lives in this room: a map together with its identity, trajectory and options (MapSession),
// and the way of a frame into it (map_frame.h). The map server and the offline mapper both use
// them, so that they make the same map.

struct MapSessionOptions {
  VoxelGridOptions grid;
  AssociationOptions association;
  IntegrationOptions integration;
  PrepareDepthOptions depth{};  ///< for frames that another process has segmented
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
    return integrated_.contains({Raw(camera), utime});
  }

  /// Finds the segments and instances of the map that the frame shows. Changes nothing.
  FrameAssociation Associate(const SegmentedFrame& frame) const;
  /// Fuses a frame and adds its pose to the trajectory, or refuses it, see MapDelta::refused.
  /// Throws when the map contains the frame.
  MapDelta Integrate(const SegmentedFrame& frame, const FrameAssociation& association);

  /// Names the map anew, so that its revisions are not mistaken for those of another map.
  void Rename(std::string map_id) { metadata_.map_id = std::move(map_id); }

  const SemanticMap& map() const { return map_; }
  const MapMetadata& metadata() const { return metadata_; }
  const MapSessionOptions& options() const { return options_; }

 private:
  MapSessionOptions options_;
  SemanticMap map_;
  MapMetadata metadata_;
  std::set<std::pair<int32_t, int64_t>> integrated_;  // (camera, utime) of each frame
};

/// 32 hexadecimal digits over what a frame did: the ids it was given and the new distances and
/// weights of the blocks it changed. Two runs part at the first frame whose digests differ.
std::string DigestFrame(const SemanticMap& map, const FrameAssociation& association,
                        const MapDelta& delta);

}  // namespace vismap
