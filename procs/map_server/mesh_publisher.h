#pragma once

#include <functional>
#include <string>
#include <vismap/mesh_delta_t.hpp>

#include "mapping/integrate.h"
#include "objects/mesh_tracker.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Publishes the surface of a map on MESH_DELTA, as a MeshTracker updates it.
class MeshPublisher {
 public:
  MeshPublisher(const MeshingOptions& options, Bus* bus)
      : options_(options), tracker_(options), bus_(bus) {}

  /// Follows this map from now on; all of it counts as changed. Publishes nothing.
  void Start(const SemanticMap& map, const std::string& map_id);
  /// Adds what a frame changed. Publishes nothing.
  void AddChanges(const SemanticMap& map, const MapDelta& delta);
  bool has_changes() const { return tracker_.has_changes(); }

  /// Publishes what changed since the last time.
  void PublishChanges(const SemanticMap& map);
  /// Publishes the whole surface.
  void PublishAll(const SemanticMap& map);
  /// Publishes what a follower at this position lacks: the blocks that changed since, or the whole
  /// surface.
  void PublishSince(const SemanticMap& map, const FollowerPosition& position);
  /// The same for a follower that has just got `position`, unless nothing newer was published or it
  /// is that of another map.
  void PublishNewer(const SemanticMap& map, const FollowerPosition& position);
  /// The same in two steps, so that the second one can be done by another thread with a copy of the
  /// map. The messages are for Send.
  MeshGap GapSince(const SemanticMap& map, const FollowerPosition& position);
  static void MakeMessages(const MeshGap& gap, const SemanticMap& map, const std::string& map_id,
                           const MeshingOptions& options,
                           const std::function<void(mesh_delta_t)>& receive);
  /// Publishes a message unless the map has been replaced since.
  void Send(mesh_delta_t message);
  /// Publishes the present revision without a change, when nothing was published for a second: from
  /// it a follower learns that it missed the last update.
  void Heartbeat(const SemanticMap& map);

  /// What was published.
  const MeshTracker& tracker() const { return tracker_; }
  /// Digest of the whole surface, made anew from the map; followers have it after PublishChanges.
  static std::string DigestOf(const SemanticMap& map, const MeshingOptions& options);

 private:
  void SendPart(const SemanticMap& map, MeshPart part);

  MeshingOptions options_;

  MeshTracker tracker_;
  Bus* bus_;
  std::string map_id_;
  Pacer heartbeat_pacer_{1.0};
};

}  // namespace vismap
