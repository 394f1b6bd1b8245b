#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "exports/outputs.h"
#include "map_server/live_map.h"
#include "requests/object_edits.h"
#include "requests/request_server.h"
#include "runtime/worker.h"

namespace vismap {

/// Carries out the MAP_REQUESTs to a map server: save, load, reset, objects, mesh, points,
/// octree, occupancy, statistics, snapshot, map, frames, cell. All but load and reset, which
/// replace the map, are answered by a thread of their own from a copy of the map (MapSnapshot), so
/// that the mapping waits only until that is made.
class MapRequests {
 public:
  /// Subscribes to MAP_REQUEST. All must outlive it.
  MapRequests(const OutputOptions& options, LiveMap* map, Bus* bus, Status* status);

  /// See RequestServer::SetShare.
  void SetShare(double share) { server_.SetShare(share); }
  /// Waits until the requests that have begun are answered.
  void Finish() { worker_.Finish(); }

 private:
  /// How a request is answered from a copy of the map.
  struct Reading {
    /// Makes the answer, in the other thread.
    std::function<Result<Answer>(const MapSnapshot&)> answer;
    /// What follows in the thread of the bus, before the answer is sent; often nothing.
    std::function<void(const MapSnapshot&)> then = nullptr;
  };
  /// The space of a copy of the map without some objects.
  using EditedCopy = std::function<Result<EditedSpace>(const MapSnapshot&)>;

  /// `prepare` checks a request and takes what of the server it needs beside the map.
  void HandleReading(const std::string& verb,
                     Result<Reading> (MapRequests::*prepare)(const map_request_t&));
  void Read(Reading reading, const RequestServer::Reply& reply);

  Result<Answer> Load(const map_request_t& request);
  Result<Answer> Reset();
  Result<Reading> ReadObjects(const map_request_t& request);
  Result<Reading> ReadMesh(const map_request_t& request);
  Result<Reading> ReadMeshGap(const map_request_t& request);
  Result<Reading> ReadPoints(const map_request_t& request);
  Result<Reading> ReadSurface(const map_request_t& request, bool points_only);
  Result<Reading> ReadOctree(const map_request_t& request);
  Result<Reading> ReadOccupancy(const map_request_t& request);
  Result<Reading> ReadSpaceGap(const map_request_t& request);
  Result<Reading> ReadStatistics(const map_request_t& request);
  Result<Reading> ReadMap(const map_request_t& request);
  Result<Reading> ReadFrames(const map_request_t& request);
  Result<Reading> ReadCell(const map_request_t& request);
  Result<Reading> Save(const map_request_t& request);

  const std::vector<ObjectSummary>& Objects() { return map_.publisher().objects().objects(); }
  const LabelPlaces& Places() { return map_.publisher().mesh().tracker().places(); }
  Result<EditedCopy> SpaceWithout(const std::string& without);

  OutputOptions options_;
  LiveMap& map_;
  Bus& bus_;
  RequestServer server_;
  Worker worker_;
};

}  // namespace vismap
