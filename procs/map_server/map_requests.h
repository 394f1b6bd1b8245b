#pragma once

#include "exports/outputs.h"
#include "map_server/live_map.h"
#include "requests/object_edits.h"
#include "requests/request_server.h"

namespace vismap {

/// Carries out the MAP_REQUESTs to a map server: save, load, reset, objects, mesh, points,
/// octree, occupancy, statistics, snapshot, frames.
class MapRequests {
 public:
  /// Subscribes to MAP_REQUEST. All must outlive it.
  MapRequests(const OutputOptions& options, LiveMap* map, Bus* bus, Status* status);

  /// See RequestServer::SetShare.
  void SetShare(double share) { server_.SetShare(share); }

 private:
  Result<Answer> Save(const map_request_t& request);
  Result<Answer> Load(const map_request_t& request);
  Result<Answer> Reset();
  Result<Answer> PublishAndSelectObjects(const map_request_t& request);
  Result<Answer> ReturnOrPublishMesh(const map_request_t& request);
  Result<Answer> ReturnObjects(const map_request_t& request, bool points_only);
  Result<Answer> ReturnOctree(const map_request_t& request);
  Result<EditedSpace> SpaceWithout(const map_request_t& request);
  const std::vector<ObjectSummary>& Objects();
  Result<Answer> PublishSpace(const map_request_t& request);

  OutputOptions options_;
  LiveMap& map_;
  RequestServer server_;
};

}  // namespace vismap
