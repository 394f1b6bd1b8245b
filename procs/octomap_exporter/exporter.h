#pragma once

#include <optional>
#include <string>
#include <vismap/map_delta_t.hpp>

#include "config/config.h"
#include "freespace/octree_builder.h"
#include "requests/request_server.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "wire/map_follower.h"

namespace vismap {

/// Follows a map by its MAP_DELTAs and turns it into octrees: publishes OCTOMAP at most once a
/// period while the map changes, and on request (the verb "octomap" of MAP_REQUEST; the answer to
/// "octomap-digest" is the digest of the map that it has). Writes octree.bt and octree.closed.bt
/// into a folder when one is configured. When it starts late or misses an update, it requests what
/// it lacks.
class Exporter {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  Exporter(const VismapConfig& config, Bus* bus, Status* status);

  /// Publishes and writes the octrees of the present state.
  Result<std::string> Export();
  /// Whether the map has changed since the last export.
  bool has_news() const;

 private:
  Result<void> OnDelta(const map_delta_t& message);
  Result<void> OnTooLarge();
  void RequestCatchUp();
  void OnTimer();
  void HandleRequests();
  Result<void> UpdateOctree();
  Result<std::string> WriteFiles();
  void TellLeftOut(const std::string& sentence);

  VismapConfig config_;
  Bus* bus_;
  Status* status_;
  MapFollower follower_;
  std::optional<OctreeBuilder> octree_;
  CatchUp catch_up_;
  double next_catch_up_ = 0;  // no request before [s]
  FollowerPosition exported_;
  Pacer export_pacer_;
  RequestServer requests_;
};

}  // namespace vismap
