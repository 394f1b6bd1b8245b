#pragma once

#include <cstdint>
#include <vector>
#include <vismap/object_list_t.hpp>

#include "exports/outputs.h"
#include "objects/mesh_tracker.h"
#include "objects/object_tracker.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "session/map_session.h"

namespace vismap {

/// Publishes the objects of a map on OBJECTS.
class ObjectsPublisher {
 public:
  ObjectsPublisher(const OutputOptions& options, Bus* bus) : options_(options), bus_(bus) {}

  /// Starts with another map. Publishes nothing.
  void Start() {
    tracker_.Clear();
    objects_.clear();
  }
  /// The map has changed since the last list.
  bool has_changes(const SemanticMap& map) const { return revision_ != map.revision; }

  /// Publishes the objects; measures only those anew whose surface has changed. `mesh`: the surface
  /// of the map as it is.
  void PublishChanges(const MapSession& session, const MeshTracker& mesh);
  /// Measures all objects anew, publishes and returns them.
  std::vector<ObjectSummary> PublishAll(const MapSession& session);
  /// The upward direction of the objects that PublishAll returned last.
  const UpDirection& up() const { return up_; }
  /// The objects that were published last; empty = none of this map yet.
  const std::vector<ObjectSummary>& objects() const { return objects_; }
  /// Publishes the last list again when nothing was published for some seconds, for those who
  /// missed it.
  void Repeat();

 private:
  std::vector<ObjectSummary> Publish(const MapSession& session, std::vector<ObjectSummary> objects);

  OutputOptions options_;
  Bus* bus_;
  ObjectTracker tracker_;
  UpDirection up_;
  std::vector<ObjectSummary> objects_;
  object_list_t last_{};  // the last message; without map_id = none yet
  int64_t revision_ = 0;  // of the last message
  Pacer repeat_pacer_{5.0};
};

}  // namespace vismap
