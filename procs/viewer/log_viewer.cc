#include "viewer/log_viewer.h"

#include <algorithm>
#include <utility>

#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/version.h"
#include "viewer/timeline.h"

namespace vismap {
namespace {

constexpr double kShowPeriod = 0.05;      // of going to a moment, at least [s]
constexpr double kFollowPeriod = 0.5;     // of going to the newest moment [s]
constexpr double kTimelinePeriod = 1.0;   // [s]
constexpr size_t kLongTimeline = 100000;  // sent five times less often [bytes]
// No map waits for a viewer of a log, so pages get all that they take.
constexpr double kMostAllowance = 64 << 20;
constexpr int64_t kMostUnacknowledged = 64 << 20;

}  // namespace

LogViewer::Page::Page(const LogRecording* recording, std::string hello)
    : surface(recording),
      feed(&surface, &board, std::move(hello), {kMostAllowance, kMostUnacknowledged, true}) {}

LogViewer::LogViewer(const VismapConfig& config, std::string page_folder, const LogSource* source)
    : options_(config.viewer),
      page_folder_(std::move(page_folder)),
      source_(source),
      recording_(&source->recording()),
      api_(source, config) {}

Result<void> LogViewer::Listen() {
  Result<std::unique_ptr<WebServer>> server =
      WebServer::Open({options_.listen, options_.hosts, options_.max_clients}, this);
  if (!server) return tl::unexpected(server.error());
  server_ = std::move(*server);
  return {};
}

void LogViewer::OnGet(const HttpTarget& target, Reply reply) {
  if (target.path.starts_with("/api/")) return api_.Get(target, reply);
  reply(ReadPageFile(page_folder_, target.path));
}

void LogViewer::OnOpen(PageId page) {
  auto opened = std::make_unique<Page>(recording_, HelloText(Version(), source_->name(), "log"));
  if (timeline_changes_ >= 0) opened->board.Set(Board::Topic::kTimeline, timeline_);
  Show(opened.get());
  pages_[page] = std::move(opened);
}

Result<void> LogViewer::OnText(PageId id, std::string_view text) {
  const auto found = pages_.find(id);
  if (found == pages_.end()) return Fail("this page is not connected");
  Page& page = *found->second;
  if (const auto taken = page.feed.OnText(text, MonotonicSeconds()); !taken) return taken;
  if (const std::optional<int64_t> wanted = page.feed.TakeMoment()) {
    page.wanted = *wanted;
    page.asked = true;
    ShowIfAsked(&page);
  }
  if (page.feed.pictures_wanted() != page.pictures) {
    page.pictures = page.feed.pictures_wanted();
    ShowPictures(&page);
  }
  return {};
}

std::optional<OutFrame> LogViewer::NextFrame(PageId id) {
  const auto found = pages_.find(id);
  if (found == pages_.end()) return std::nullopt;
  Page& page = *found->second;
  if (page.thinnings != recording_->thinnings()) Show(&page);
  return page.feed.Next(MonotonicSeconds());
}

// A page that asks all the time takes at most half of the time that there is.
void LogViewer::ShowIfAsked(Page* page) {
  const double begin = MonotonicSeconds();
  if (!page->asked || begin < page->next_show) return;
  Show(page);
  const double end = MonotonicSeconds();
  page->next_show = end + std::max(kShowPeriod, end - begin);
}

// Sends the page from the moment that it looks at to the one that it wants.
void LogViewer::Show(Page* page) {
  page->asked = false;
  page->thinnings = recording_->thinnings();
  const std::optional<Moment> moment = recording_->MomentAt(page->wanted);
  if (!moment) return;
  page->feed.SetLacking(page->surface.Show(*moment));
  page->board.map = page->surface.Summary();
  page->feed.TellMap();
  ShowObjects(page);
  std::vector<CameraView> cameras;
  for (auto& [view, positions] : recording_->CamerasAt(moment->frames)) {
    view.positions = positions;
    cameras.push_back(view);
  }
  page->board.Set(Board::Topic::kCameras, CamerasText(cameras));
  for (const auto& [camera, p_W] : recording_->PathFrom(page->path_length)) {
    page->board.AddPosition(camera, p_W);
    ++page->path_length;
  }
  ShowPictures(page);
}

// Objects of another moment must not stay: without a list, the page gets an empty one.
void LogViewer::ShowObjects(Page* page) {
  const Moment& moment = page->surface.moment();
  page->object_lists = recording_->object_lists();
  const Result<std::string> objects = recording_->ObjectsTextAt(moment.frames);
  if (!objects && !std::exchange(page->told_objects_problem, true))
    page->feed.AddNotice("error",
                         "objects of the recording could not be read: " + objects.error().message);
  if (objects && !objects->empty()) return page->board.Set(Board::Topic::kObjects, *objects);
  object_list_t none{};
  none.map_id = recording_->map_id();
  none.revision = moment.frames;
  none.utime = moment.utime;
  page->board.Set(Board::Topic::kObjects, ObjectsText(none));
}

void LogViewer::ShowPictures(Page* page) {
  const int64_t frames = page->surface.moment().frames;
  for (const auto& [view, positions] : recording_->CamerasAt(frames)) {
    const int camera = Raw(view.header.camera_id);
    if (!page->feed.WantsPicture(camera)) {
      page->pictures_sent.erase(camera);
      continue;
    }
    if (std::exchange(page->pictures_sent[camera], view.picture) == view.picture) continue;
    const Result<FrameBytes> picture = recording_->PictureAt(camera, frames);
    if (picture && *picture != nullptr) page->board.SetPicture(camera, **picture);
  }
}

void LogViewer::TellTimeline() {
  const double now = MonotonicSeconds();
  if (now < next_timeline_ || timeline_changes_ == recording_->changes()) return;
  timeline_changes_ = recording_->changes();
  timeline_ = TimelineText(*recording_);
  next_timeline_ = now + (timeline_.size() > kLongTimeline ? 5 : 1) * kTimelinePeriod;
  for (auto& [id, page] : pages_) page->board.Set(Board::Topic::kTimeline, timeline_);
}

// While the log is mapped, better moments for what the page wants come.
void LogViewer::ShowChanges(Page* page) {
  const double now = MonotonicSeconds();
  const std::optional<Moment> newest = recording_->Newest();
  const std::optional<Moment> moment = recording_->MomentAt(page->wanted);
  if (!newest || !moment || now < page->next_follow) return;
  const bool is_shown = page->surface.moment().frames == moment->frames;
  const bool has_new_list =
      moment->frames == newest->frames && page->object_lists != recording_->object_lists();
  if (is_shown && !has_new_list) return;
  page->next_follow = now + kFollowPeriod;
  if (is_shown) return ShowObjects(page);
  Show(page);
}

void LogViewer::OnTick() {
  TellTimeline();
  api_.Poll();
  for (auto& [id, page] : pages_) {
    page->feed.Allow(kMostAllowance);
    ShowIfAsked(page.get());
    ShowChanges(page.get());
    if (!page->surface.problem().empty() && !std::exchange(page->told_problem, true))
      page->feed.AddNotice("error",
                           "blocks of the recording could not be read: " + page->surface.problem());
  }
}

}  // namespace vismap
