#include "map_server/live_map.h"

#include <filesystem>
#include <utility>

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
          {.mesh = config.map_server.mesh_period_s, .objects = config.map_server.objects_period_s}, bus,
          StageTimings(status)),
      store_(config.map_server.save_on_exit, config.map_server.save_period_s, status) {
  Reset();
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
  publisher_.Start(*session_);
}

void LiveMap::Reset() { Start(MapSession(config_, NewMetadata())); }

Result<std::string> LiveMap::Load(const std::string& path) {
  Result<MapSession> session =
      MapStore::Load(path, config_, NewMetadata().map_id);
  if (!session) return tl::unexpected(session.error());
  Start(std::move(*session));
  return "loaded " + path + " with " + std::to_string(session_->map().revision) +
         " frames as map " + session_->metadata().map_id;
}

Result<std::string> LiveMap::Recover() {
  const std::string& path = config_.map_server.save_on_exit;
  Result<std::string> loaded = "nothing to recover: there is no " + path;
  if (std::filesystem::exists(path)) loaded = Load(path);
  if (!loaded) return loaded;
  if (const Result<void> started = store_.StartJournal(*session_); !started)
    return tl::unexpected(started.error());
  return *loaded +
         "; frames lacking that were committed later: " + std::to_string(store_.lacking_frames());
}

MappedFrame LiveMap::Integrate(const SegmentedFrame& frame) {
  MappedFrame mapped = MapFrame(frame, session_.get(), StageTimings(status_));
  store_.AddFrame({frame.frame.header.camera_id, frame.frame.header.utime});
  publisher_.PublishFrame(*session_, mapped.delta);
  return mapped;
}

void LiveMap::PublishAndSaveIfDue() {
  publisher_.PublishIfDue(*session_);
  store_.SaveIfDue(*session_);
}

}  // namespace vismap
