#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "config/config.h"
#include "viewer/board.h"
#include "viewer/client_feed.h"
#include "viewer/log_api.h"
#include "viewer/log_source.h"
#include "viewer/page_moment.h"
#include "viewer/web_server.h"

namespace vismap {

/// Serves the page of a log: each page looks at a moment of its own. Joins no bus.
class LogViewer : public WebHandler {
 public:
  /// `source` must outlive it.
  LogViewer(const VismapConfig& config, std::string page_folder, const LogSource* source);

  /// Fails when the address cannot be used.
  Result<void> Listen();
  std::string address() const { return server_->address(); }
  /// Serves until stop is requested.
  void Run(const StopSignal& stop) { server_->Run(nullptr, stop); }

  void OnGet(const HttpTarget& target, Reply reply) override;
  void OnOpen(PageId page) override;
  void OnClose(PageId page) override { pages_.erase(page); }
  Result<void> OnText(PageId page, std::string_view text) override;
  std::optional<OutFrame> NextFrame(PageId page) override;
  void OnTick() override;

 private:
  struct Page {
    Page(const LogRecording* recording, std::string hello);
    Board board;
    PageMoment surface;
    ClientFeed feed;
    int64_t wanted = ClientFeed::kNewestMoment;  // frames
    bool asked = false;                          // for it, and has not got it yet
    int64_t thinnings = 0, object_lists = 0;
    size_t path_length = 0;                // frames whose positions it knows
    std::set<int> pictures;                // that it wanted
    std::map<int, int64_t> pictures_sent;  // frame of the picture by camera
    double next_show = 0, next_follow = 0;
    bool told_problem = false, told_objects_problem = false;
  };
  void Show(Page* page);
  void ShowIfAsked(Page* page);
  void ShowChanges(Page* page);
  void ShowObjects(Page* page);
  void ShowPictures(Page* page);
  void TellTimeline();

  ViewerOptions options_;
  std::string page_folder_;
  const LogSource* source_;
  const LogRecording* recording_;
  std::unique_ptr<WebServer> server_;  // before what may keep its replies
  LogApi api_;
  std::map<PageId, std::unique_ptr<Page>> pages_;
  std::string timeline_;
  int64_t timeline_changes_ = -1;
  double next_timeline_ = 0;
};

}  // namespace vismap
