#pragma once

#include <map>
#include <memory>
#include <string>
#include <vismap/map_delta_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/object_list_t.hpp>

#include "config/process_options.h"
#include "runtime/bus.h"
#include "runtime/catch_up.h"
#include "runtime/status.h"
#include "viewer/api.h"
#include "viewer/back_watch.h"
#include "viewer/board.h"
#include "viewer/camera_watch.h"
#include "viewer/client_feed.h"
#include "viewer/evidence.h"
#include "viewer/map_copy.h"
#include "viewer/process_list.h"
#include "viewer/questions.h"
#include "viewer/web_server.h"

namespace vismap {

/// Serves a web page of the live map. It only listens on the bus, but for requests for what it
/// missed and for what a page asks; nothing can be changed through it.
class MapViewer : public WebHandler {
 public:
  /// Subscribes to its inputs. `pictures`: how a second bus for frames is joined. `bus` and
  /// `status` must outlive it.
  MapViewer(const ViewerOptions& options, BusOptions pictures, std::string page_folder, Bus* bus,
            Status* status);

  /// Fails when the address cannot be used.
  Result<void> Listen();
  std::string address() const { return server_->address(); }
  /// Serves until stop is requested.
  void Run(const StopSignal& stop) { server_->Run(bus_, stop); }

  void OnGet(const HttpTarget& target, Reply reply) override;
  void OnOpen(PageId page) override;
  void OnClose(PageId page) override;
  Result<void> OnText(PageId page, std::string_view text) override;
  std::optional<OutFrame> NextFrame(PageId page) override;
  void OnTick() override;

 private:
  Result<void> OnMesh(const mesh_delta_t& message);
  Result<void> OnSpace(const map_delta_t& message);
  Result<void> OnObjects(const object_list_t& message);
  template <typename Follower>
  Result<void> Follow(FollowOutcome outcome, const Follower& follower, CatchUp* catch_up,
                      const char* what);
  void OnMapServer(const process_status_t& status);
  void GiveUpParts();
  void TellChanges();
  void OnSecond();
  void AskForPath();
  Result<void> AddPath(const map_reply_t& reply);
  void SetState();
  void Notice(const std::string& level, const std::string& sentence);

  ViewerOptions options_;
  std::string page_folder_;
  Bus* bus_;
  Status* status_;
  Board board_;
  std::unique_ptr<WebServer> server_;  // before what may keep its replies
  MapCopy surface_;
  MapFollower space_;
  ProcessList processes_;
  Questions questions_;
  Api api_;
  Evidence evidence_;
  CameraWatch cameras_;
  CatchUp mesh_catch_up_, space_catch_up_;
  BackWatch mesh_back_, space_back_;
  std::map<PageId, ClientFeed> feeds_;
  std::map<const char*, double> rest_until_;  // of a copy that is too large, MonotonicSeconds
  std::string too_large_;
  double server_heard_ = -1;  // MonotonicSeconds; -1 = never
  bool server_was_gone_ = false;
  int64_t server_start_utime_ = 0;               // [us]
  std::map<std::string, int64_t> server_bytes_;  // by layer
  std::string map_id_, path_map_id_;
  size_t positions_ = 0;     // of the path, all cameras together
  bool path_asked_ = false;  // and not answered yet
  double last_tick_ = 0, next_second_ = 0;
};

}  // namespace vismap
