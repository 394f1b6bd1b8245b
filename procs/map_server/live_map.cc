#include "map_server/live_map.h"

#include <utility>

#include "base/format.h"
#include "runtime/clock.h"
#include "runtime/version.h"
#include "settings/settings.h"

namespace vismap {

LiveMap::LiveMap(const VismapConfig& config, Bus* bus, Status* status)
    : config_(config),
      bus_(bus),
      status_(status),
      publisher_(
          config,
          {.mesh = config.map_server.mesh_period_s, .objects = config.map_server.objects_period_s},
          bus, StageTimings(status)),
      store_(config.map_server, status),
      history_(config, status) {
  StartEmpty();
}

MapMetadata LiveMap::NewMetadata() const {
  MapMetadata metadata;
  metadata.map_id = bus_->source() + "-" + std::to_string(WallUtime());
  metadata.config = PrintConfig(config_);
  metadata.created_by = std::string("vismap-map-server ") + Version();
  return metadata;
}

void LiveMap::Start(MapSession session) {
  session_ = std::make_unique<MapSession>(std::move(session));
  trajectory_ = {};
  trajectory_.Follow(session_->metadata().trajectory);
  publisher_.Start(*session_);
}

void LiveMap::StartEmpty() {
  Start(MapSession(config_, NewMetadata()));
  frames_id_ = session_->metadata().map_id;
  store_.BeginMap(*session_);
}

void LiveMap::Reset() {
  StartEmpty();
  history_.BeginMap();
}

std::unique_ptr<MapSession> LiveMap::ReplaceByCorrected(MapSession session) {
  session.Rename(NewMetadata().map_id);
  std::unique_ptr<MapSession> old = std::move(session_);
  Start(std::move(session));
  store_.BeginMap(*session_);
  PublishAll();
  return old;
}

// Returns a sentence.
std::string LiveMap::Continue(MapSession session, const std::filesystem::path& path) {
  Start(std::move(session));
  frames_id_ = session_->metadata().map_id;
  store_.ContinueMap(*session_, path);
  return "loaded " + path.string() + " with " + std::to_string(session_->map().revision) +
         " frames as map " + session_->metadata().map_id;
}

Result<std::string> LiveMap::Load(const std::filesystem::path& path) {
  Result<MapSession> session = ReadSavedMap(path, config_, NewMetadata().map_id);
  if (!session) return tl::unexpected(session.error());
  std::string sentence = Continue(std::move(*session), path);
  history_.BeginMap();
  return sentence;
}

Result<std::string> LiveMap::LoadNamed(const std::string& name) {
  const Result<std::filesystem::path> path = store_.FindNamed(name);
  if (!path) return tl::unexpected(path.error());
  return Load(*path);
}

Result<std::string> LiveMap::Recover() {
  Result<RecoveredMap> recovered = store_.Recover(config_, NewMetadata().map_id);
  if (!recovered) return tl::unexpected(recovered.error());
  std::string sentence = "nothing to recover: there is no " + config_.map_server.save_on_exit;
  if (recovered->session)
    sentence = Continue(std::move(*recovered->session), recovered->path);
  else if (!recovered->unusable.empty())
    sentence = "no saved map can be used, so the map is empty";
  const std::vector<FrameKey> taken = TakeFramesFromJournal(&sentence);
  store_.StartJournal(*session_);
  for (const FrameKey& frame : taken) store_.AddFrame(frame);
  return sentence +
         "; frames lacking that were committed later: " + std::to_string(store_.lacking_frames());
}

// Adds to the sentence what it did.
std::vector<FrameKey> LiveMap::TakeFramesFromJournal(std::string* sentence) {
  ContinuedMap continued = history_.Continue(std::move(*session_), NewMetadata());
  status_->SetFindings("recovery", continued.remarks);
  for (const std::string& remark : continued.remarks) *sentence += "; " + remark;
  if (!continued.taken.empty()) {
    *sentence += "; taken from the journal of frames: " +
                 FormatCount(static_cast<int64_t>(continued.taken.size()), "frame");
  }
  Start(std::move(continued.session));
  if (continued.made_anew) {
    frames_id_ = session_->metadata().map_id;
    store_.BeginMap(*session_);
  }
  return std::move(continued.taken);
}

MappedFrame LiveMap::Integrate(const SegmentedFrame& frame) {
  history_.BeforeFrame(*session_);
  MappedFrame mapped = MapFrame(frame, session_.get(), StageTimings(status_));
  if (!mapped.delta.refused.empty()) return mapped;
  trajectory_.Follow(session_->metadata().trajectory);
  history_.Saw(session_->map().revision, SeenIn(frame, mapped.association));
  store_.AddFrame({frame.frame.header.camera_id, frame.frame.header.utime});
  publisher_.PublishFrame(*session_, mapped.delta);
  return mapped;
}

std::shared_ptr<MapSnapshot> LiveMap::Snapshot() const {
  const MapMetadata& all = session_->metadata();
  MapMetadata metadata{all.map_id, all.config, all.created_by, all.class_names, {}};
  auto copy =
      std::make_shared<MapSnapshot>(MapSnapshot{session_->map(), std::move(metadata), trajectory_});
  copy_ = copy;
  return copy;
}

std::vector<MemoryLayer> LiveMap::Memory() {
  const size_t copies = (copy_.expired() ? 0 : 1) + history_.checkpoints().size();
  return MeasureLayers(*session_, publisher_, copies);
}

void LiveMap::ReportMemoryIfDue() {
  constexpr double kShare = 0.01;  // of the time
  const auto report = [this] {
    for (const MemoryLayer& layer : Memory()) {
      status_->SetCounter(std::string("memory.") + layer.name + "_bytes",
                          static_cast<int64_t>(layer.bytes));
    }
  };
  memory_pacer_.RunIfDue(report, kShare);
}

void LiveMap::PublishAndSaveIfDue(double share) {
  publisher_.PublishIfDue(*session_, share);
  store_.SaveIfDue(*session_, share);
}

}  // namespace vismap
