#pragma once

#include <string>

#include "base/stopwatch.h"
#include "map_server/mesh_publisher.h"
#include "map_server/objects_publisher.h"
#include "map_server/occupancy_publisher.h"
#include "runtime/pacer.h"
#include "session/map_session.h"

namespace vismap {

/// How often the products of a map are published.
struct PublishPeriods {
  double mesh;     ///< least time between two updates of the surface [s]; 0 = every frame
  double objects;  ///< least time between two object lists [s]; 0 = every frame
};

/// Publishes a map: free and occupied space after every frame, surface and objects now and then,
/// never so often that they take more than a share of the time.
class MapPublisher {
 public:
  /// `watch` measures the stages "publishing", "meshing" and "objects". `bus` must outlive it.
  MapPublisher(const OutputOptions& options, const PublishPeriods& periods, Bus* bus,
               Stopwatch watch);

  /// Starts with another map. Publishes nothing.
  void Start(const MapSession& session);
  /// Publishes the space that a frame changed. The surface that it changed follows later.
  void PublishFrame(const MapSession& session, const MapDelta& delta);
  /// Publishes surface and objects if they have changed and are due. Each takes at most `share` of
  /// the time.
  void PublishIfDue(const MapSession& session, double share = kUsualShare);
  void PublishMesh(const MapSession& session);
  /// Publishes the objects if they have changed since the last list, and returns them.
  const std::vector<ObjectSummary>& FreshObjects(const MapSession& session);
  /// Publishes everything anew.
  void PublishAll(const MapSession& session);
  /// Repeats the last state of each stream now and then, for those who missed it.
  void Repeat(const MapSession& session);

  OccupancyPublisher& occupancy() { return occupancy_; }
  MeshPublisher& mesh() { return mesh_; }
  ObjectsPublisher& objects() { return objects_; }

 private:
  void PublishObjects(const MapSession& session);

  OccupancyPublisher occupancy_;
  MeshPublisher mesh_;
  ObjectsPublisher objects_;
  Pacer mesh_pacer_, objects_pacer_;
  Stopwatch watch_;
};

}  // namespace vismap
