#include "viewer/viewer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/format.h"
#include "base/json_text.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/version.h"
#include "wire/map_update.h"

namespace vismap {
namespace {

constexpr double kRestTime = 60;       // before a map that was too large is asked for again [s]
constexpr double kServerPatience = 3;  // the map server speaks at least once a second [s]

FollowLimits LimitsOf(const ViewerOptions& options) {
  return {.max_bytes = static_cast<size_t>(options.max_map_mb) * kMegabyte};
}

}  // namespace

MapViewer::MapViewer(const ViewerOptions& options, BusOptions pictures, std::string page_folder,
                     Bus* bus, Status* status)
    : options_(options),
      page_folder_(std::move(page_folder)),
      bus_(bus),
      status_(status),
      surface_(LimitsOf(options)),
      space_(LimitsOf(options)),
      questions_(bus),
      api_(&board_, &space_, &processes_, &questions_),
      evidence_(options, bus, &surface_, status),
      cameras_(std::move(pictures),
               {options.max_picture_hz, evidence_.enabled() ? options.evidence_hz : 0}, &board_,
               [this](const auto& frame) { evidence_.Offer(frame); }),
      mesh_catch_up_(bus, "mesh"),
      space_catch_up_(bus, "snapshot") {
  bus_->Subscribe<mesh_delta_t>(kMeshDeltaChannel,
                                [this](const mesh_delta_t& message) { return OnMesh(message); });
  bus_->Subscribe<map_delta_t>(kMapDeltaChannel,
                               [this](const map_delta_t& message) { return OnSpace(message); });
  bus_->Subscribe<object_list_t>(
      kObjectsChannel, [this](const object_list_t& message) { return OnObjects(message); },
      Delivery::kLatest);
  bus_->Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& message) {
    processes_.Add(message, MonotonicSeconds());
    if (message.process == "map-server") OnMapServer(message);
  });
  bus_->Subscribe<navigation_status_t>(
      kNavigationChannel,
      [this](const navigation_status_t& message) {
        board_.Set(Board::Topic::kNavigation, NavigationText(message));
      },
      Delivery::kLatest);
  bus_->Every(0.25, [this] { GiveUpParts(); });
  mesh_catch_up_.Request(surface_.position());
  space_catch_up_.Request(space_.position());
}

Result<void> MapViewer::Listen() {
  Result<std::unique_ptr<WebServer>> server =
      WebServer::Open({options_.listen, options_.hosts, options_.max_clients}, this);
  if (!server) return tl::unexpected(server.error());
  server_ = std::move(*server);
  return {};
}

template <typename Follower>
Result<void> MapViewer::Follow(FollowOutcome outcome, const Follower& follower, CatchUp* catch_up,
                               const char* what) {
  const bool rests = MonotonicSeconds() < rest_until_[what];
  switch (outcome) {
    case FollowOutcome::kNeedsSnapshot:
      if (!rests) catch_up->Request(follower.position());
      break;
    case FollowOutcome::kBroken:
      if (!rests) catch_up->Request(follower.position());
      return Fail("an update of the " + std::string(what) + " is inconsistent; asking again");
    case FollowOutcome::kTooLarge:
      // Asking for the map again would only cost the map server work.
      rest_until_[what] = MonotonicSeconds() + kRestTime;
      too_large_ = "the " + std::string(what) + " of the map needs more than " +
                   std::to_string(options_.max_map_mb) +
                   " MB (viewer.max_map_mb), so it is not shown";
      Notice("error", too_large_);
      return Fail(too_large_);
    case FollowOutcome::kApplied:
    case FollowOutcome::kWaiting:
    case FollowOutcome::kIgnored:
      break;
  }
  return {};
}

Result<void> MapViewer::OnMesh(const mesh_delta_t& message) {
  const StageTimer timer(status_, "surface");
  server_heard_ = MonotonicSeconds();
  if (mesh_back_.Heard({message.map_id, message.revision}, message.full, surface_.position(),
                       MonotonicSeconds())) {
    surface_.RequireSnapshot();
    path_map_id_.clear();  // the path is another one as well
  }
  const FollowOutcome outcome = surface_.Apply(message, MonotonicSeconds());
  // At once, so that no page gets a block that the digest which it compares with does not count
  // yet.
  TellChanges();
  return Follow(outcome, surface_, &mesh_catch_up_, "surface");
}

Result<void> MapViewer::OnSpace(const map_delta_t& message) {
  const StageTimer timer(status_, "space");
  server_heard_ = MonotonicSeconds();
  Result<MapUpdate> update = Decode(message);
  if (!update) return tl::unexpected(update.error());
  if (space_back_.Heard({message.map_id, message.revision}, message.full, space_.position(),
                        MonotonicSeconds()))
    space_.RequireSnapshot();
  const FollowOutcome outcome = space_.Apply(std::move(*update), MonotonicSeconds());
  space_.ConsumeChanges();  // slices are cut anew each time
  return Follow(outcome, space_, &space_catch_up_, "free space");
}

Result<void> MapViewer::OnObjects(const object_list_t& message) {
  constexpr size_t kMostText = 32 << 20;
  std::string text = ObjectsText(message);
  if (text.size() > kMostText) return Fail("the list of objects is larger than 32 MB");
  board_.Set(Board::Topic::kObjects, text);
  evidence_.SetObjects(message);
  return {};
}

void MapViewer::OnMapServer(const process_status_t& status) {
  server_heard_ = MonotonicSeconds();
  server_start_utime_ = status.start_utime;
  server_bytes_ = MemoryLayers(status);
}

void MapViewer::GiveUpParts() {
  const double now = MonotonicSeconds();
  surface_.GiveUpStaleParts(now);
  space_.GiveUpStaleParts(now);
  if (!surface_.in_sync() && now >= rest_until_["surface"])
    mesh_catch_up_.Request(surface_.position());
  if (!space_.in_sync() && now >= rest_until_["free space"])
    space_catch_up_.Request(space_.position());
}

void MapViewer::OnGet(const HttpTarget& target, Reply reply) {
  if (Evidence::Answers(target.path)) return evidence_.Get(target, reply);
  if (target.path.starts_with("/api/")) return api_.Get(target, reply);
  reply(ReadPageFile(page_folder_, target.path));
}

void MapViewer::OnOpen(PageId page) {
  feeds_.emplace(page, ClientFeed(&surface_, &board_, HelloText(Version(), bus_->source())));
  status_->Count("pages_opened");
}

void MapViewer::OnClose(PageId page) { feeds_.erase(page); }

Result<void> MapViewer::OnText(PageId page, std::string_view text) {
  const auto found = feeds_.find(page);
  if (found == feeds_.end()) return Fail("this page is not connected");
  return found->second.OnText(text, MonotonicSeconds());
}

std::optional<OutFrame> MapViewer::NextFrame(PageId page) {
  const auto found = feeds_.find(page);
  if (found == feeds_.end()) return std::nullopt;
  return found->second.Next(MonotonicSeconds());
}

void MapViewer::OnTick() {
  const double now = MonotonicSeconds();
  const double passed = std::clamp(now - last_tick_, 0.0, 0.2);
  last_tick_ = now;
  if (now >= next_second_) {
    next_second_ = now + 1;
    OnSecond();
  }
  TellChanges();
  std::set<int> pictures;
  // Pages that get nothing leave their share to the others.
  const auto sharers = std::count_if(feeds_.begin(), feeds_.end(),
                                     [](const auto& e) { return e.second.NeedsAllowance(); });
  for (auto& [page, feed] : feeds_) {
    if (feed.NeedsAllowance())
      feed.Allow(options_.budget_mb_s * 1e6 * passed / static_cast<double>(sharers));
    pictures.insert(feed.pictures_wanted().begin(), feed.pictures_wanted().end());
  }
  cameras_.Poll(now, !feeds_.empty(), pictures);
}

void MapViewer::TellChanges() {
  const SurfaceChanges changes = surface_.ConsumeChanges();
  board_.map = surface_.Summary();
  board_.map.server_start_utime = server_start_utime_;
  board_.map.bytes = server_bytes_;
  board_.map.age_s = server_heard_ < 0 ? -1 : MonotonicSeconds() - server_heard_;
  if (space_.occupancy()) board_.map.voxel_size_m = space_.occupancy()->cell_size();
  if (changes.reset && !map_id_.empty() && map_id_ != surface_.position().map_id) {
    board_.Remove(Board::Topic::kObjects);  // the page itself says what has happened
    evidence_.ForgetFrames();
  }
  map_id_ = surface_.position().map_id;
  if (!changes.reset && changes.blocks.empty()) return;
  for (auto& [page, feed] : feeds_) feed.OnChanges(changes);
}

void MapViewer::OnSecond() {
  const double now = MonotonicSeconds();
  board_.Set(Board::Topic::kProcesses, processes_.Text(now, WallUtime()));
  AskForPath();
  const bool gone = server_heard_ >= 0 && now - server_heard_ > kServerPatience;
  if (gone != server_was_gone_)
    Notice(gone ? "warning" : "info",
           gone ? "the map server was not heard for 3 seconds; what is shown may be old"
                : "the map server is there again");
  server_was_gone_ = gone;
  SetState();
}

void MapViewer::SetState() {
  status_->SetCounter("pages", static_cast<int64_t>(feeds_.size()));
  status_->SetCounter("requests_refused", server_ ? server_->refused() : 0);
  status_->SetCounter("map_revision", surface_.position().revision);
  status_->SetCounter("updates_missed", surface_.gaps() + space_.gaps());
  status_->SetCounter("surface_bytes", static_cast<int64_t>(surface_.bytes()));
  status_->SetCounter("space_bytes", static_cast<int64_t>(space_.bytes()));
  if (surface_.in_sync() && space_.in_sync()) too_large_.clear();
  const std::string trouble = !too_large_.empty()   ? too_large_
                              : server_heard_ < 0   ? "nothing was heard of a map server yet"
                              : server_was_gone_    ? "the map server was not heard for 3 s"
                              : !surface_.in_sync() ? "waiting for the surface of the map"
                                                    : "";
  status_->Set(trouble.empty() ? ProcessState::kRunning : ProcessState::kWaiting, trouble);
}

void MapViewer::Notice(const std::string& level, const std::string& sentence) {
  for (auto& [page, feed] : feeds_) feed.AddNotice(level, sentence);
}

// Where the cameras were comes from the map server, so that a page that comes late has all of it.
void MapViewer::AskForPath() {
  const FollowerPosition& position = surface_.position();
  if (position.revision < 0 || feeds_.empty() || path_asked_) return;
  if (position.map_id != path_map_id_) {
    path_map_id_ = position.map_id;
    positions_ = 0;
    board_.RestartPaths();
  }
  if (static_cast<int64_t>(positions_) >= position.revision) return;
  if (positions_ >= Board::kMostPositions) return;
  path_asked_ = true;
  questions_.Ask("frames", "trajectory=" + std::to_string(positions_),
                 [this](const Questions::Answered& answer) {
                   path_asked_ = false;
                   if (!answer) return;
                   if (const Result<void> added = AddPath(*answer); !added)
                     LogWarningRateLimited("path", "the answer about the cameras' path is wrong: " +
                                                       added.error().message);
                 });
}

Result<void> MapViewer::AddPath(const map_reply_t& reply) {
  if (reply.map_id != path_map_id_) return {};
  const Result<nlohmann::json> json =
      ParseJson({reinterpret_cast<const char*>(reply.payload.data()), reply.payload.size()});
  if (!json) return tl::unexpected(json.error());
  if (!json->is_array()) return Fail("expected an array, found " + DescribeJson(*json));
  for (const nlohmann::json& frame : *json) {
    const bool four =
        frame.is_array() && frame.size() == 4 && frame[0].is_number_integer() &&
        std::all_of(frame.begin(), frame.end(), [](const auto& x) { return x.is_number(); });
    if (!four) return Fail("expected [camera, x, y, z], found " + DescribeJson(frame));
    board_.AddPosition(frame[0].get<int>(),
                       {frame[1].get<float>(), frame[2].get<float>(), frame[3].get<float>()});
    ++positions_;
  }
  return {};
}

}  // namespace vismap
