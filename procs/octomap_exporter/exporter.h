#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vismap/map_delta_t.hpp>
#include <vismap/navigation_status_t.hpp>

#include "config/config.h"
#include "octomap_exporter/camera_path.h"
#include "octomap_exporter/distance_publisher.h"
#include "octomap_exporter/grid_publisher.h"
#include "octomap_exporter/latched_trees.h"
#include "octomap_exporter/leaf_publisher.h"
#include "octomap_exporter/map_up.h"
#include "octomap_exporter/space_without.h"
#include "octomap_exporter/tree_set.h"
#include "requests/navigation_answers.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/pacer.h"
#include "runtime/status.h"
#include "wire/map_follower.h"

namespace vismap {

/// Follows a map by its MAP_DELTAs and turns it into octrees, see procs/README.md, Octrees:
/// publishes them at most once a period while the map changes, keeps them latched, says on
/// NAVIGATION how old they are, and answers requests ("octomap": a tree as the request wants it;
/// "octomap-delta": leaves that a follower lacks; "grid", "distances", "clearance", "frontiers":
/// see navigation_answers.h; "octomap-digest": digest of the map that it has). Writes octree.bt and
/// octree.closed.bt into a folder when one is configured; files of an earlier run or map that are
/// there get the ending .previous. When it starts late or misses an update, it requests what it
/// lacks.
class Exporter {
 public:
  /// Subscribes to its inputs. `bus` and `status` must outlive it.
  Exporter(const VismapConfig& config, Bus* bus, Status* status);

  /// Publishes and writes the octrees of the present state; nothing while nothing is known.
  Result<std::string> Export();
  /// Whether the map has changed since the last export.
  bool has_news() const;

 private:
  Result<void> OnDelta(const map_delta_t& message);
  Result<void> OnTooLarge();
  void RequestCatchUp();
  void OnTimer();
  void ExportIfDue();
  std::string Trouble() const;
  void SetState();
  void HandleRequests();
  /// Answers from the space that a request is about: the exporter's own, or, when the request
  /// leaves objects out, a copy of the blocks of `region` (nullopt = all) without them, once the
  /// map server has said what differs.
  using AnswerFromSpace = std::function<Result<Answer>(const OccupancyMap&)>;
  void WithSpace(const map_request_t& request, const std::optional<BlockRegion>& region,
                 const RequestServer::Reply& reply, AnswerFromSpace answer);
  void BeginOctomap(const map_request_t& request, const RequestServer::Reply& reply);
  Result<Answer> AnswerDelta(const map_request_t& request);
  using Question = Result<Answer> (*)(const NavigationSpace&, const map_request_t&);
  void BeginQuestion(const map_request_t& request, Question ask, const RequestServer::Reply& reply);
  Result<void> BringUpToDate();
  Result<void> UpdateTrees();
  void FollowPath(bool anew);
  void PublishGrid();
  void TellOfGrid(const std::optional<std::string>& problem);
  NavigationSpace Space() const;
  Result<std::string> Publish();
  Result<std::string> WriteFiles();
  void SetFilesAside();
  void TellLeftOut(const std::string& sentence);
  void ForgetTrees();
  void PublishNavigation();

  VismapConfig config_;
  Bus* bus_;
  Status* status_;
  MapFollower follower_;
  std::optional<TreeSet> trees_;
  LatchedTrees latched_;
  LeafPublisher leaf_deltas_;
  DistancePublisher distances_;
  GridPublisher grid_;
  MapUp up_;
  std::string grid_error_;  // why no grid is published; "" = one is, or none is wanted
  CameraPath path_;
  size_t path_used_ = 0;  // positions that trees_ has got
  CatchUp catch_up_;
  double next_catch_up_ = 0;  // no request before [s]
  FollowerPosition exported_;
  FollowerPosition updated_;  // of trees_ and distances_
  std::string export_error_;  // why there is no tree; "" = there is one, or nothing is known
  std::optional<double> server_heard_;  // when the map server was heard last, MonotonicSeconds
  Pacer export_pacer_;
  RequestServer requests_;
  SpaceWithout space_without_;
};

}  // namespace vismap
