#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/object_list_t.hpp>

#include "exports/outputs.h"
#include "map_server/map_snapshot.h"
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
  void PublishAll(const MapSession& session);
  /// Publishes objects that another thread has measured in a copy of the map, unless newer ones
  /// were published. `session`: of the map as it is now.
  void PublishLate(const MapSession& session, const MapSnapshot& copy,
                   std::vector<ObjectSummary> objects);
  /// The objects that were published last; empty = none of this map yet.
  const std::vector<ObjectSummary>& objects() const { return objects_; }
  /// Publishes the last list again when nothing was published for some seconds, for those who
  /// missed it.
  void Repeat();

 private:
  void Publish(const SemanticMap& map, const std::string& map_id,
               std::vector<ObjectSummary> objects);

  OutputOptions options_;
  Bus* bus_;
  ObjectTracker tracker_;
  std::vector<ObjectSummary> objects_;
  object_list_t last_{};  // the last message; without map_id = none yet
  int64_t revision_ = 0;  // of the last message
  Pacer repeat_pacer_{5.0};
};

}  // namespace vismap
