#pragma once

#include <optional>
#include <string>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_request_t.hpp>

#include "config/config.h"
#include "freespace/octree_builder.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/status.h"
#include "wire/map_follower.h"

namespace vismap {

/// Follows a map by its MAP_DELTAs and turns it into octrees: publishes OCTOMAP at most once a
/// period while the map changes, and on request ("octomap" on MAP_REQUEST; "octomap-digest" answers
/// the digest of what it holds); writes octree.bt and octree.closed.bt into a folder when
/// configured. Asks for what it lacks when it starts late or misses an update.
class Exporter {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  Exporter(const VismapConfig& config, Bus* bus, Status* status);

  /// Publishes and writes the octrees of the present state.
  Result<std::string> Export();
  /// The map has changed since the last export.
  bool has_news() const;

 private:
  Result<void> OnDelta(const map_delta_t& message);
  void OnRequest(const map_request_t& request);
  void OnTimer();
  Result<void> BringUpToDate();
  Result<std::string> WriteFiles();

  VismapConfig config_;
  Bus* bus_;
  Status* status_;
  MapFollower follower_;
  std::optional<OctreeBuilder> octree_;
  CatchUp catch_up_;
  FollowerPosition exported_;
  double export_due_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
