#include "map_server/map_server.h"

#include "runtime/log.h"
#include "settings/settings.h"

namespace vismap {

namespace {
constexpr double kTimerPeriod = 0.5;  // [s]
}  // namespace

MapServer::MapServer(const VismapConfig& config, Bus* bus, Status* status)
    : bus_(*bus),
      map_(config, bus, status),
      frames_(&map_, config, bus, status),
      requests_(config, &map_, bus, status),
      corrections_(config.map_server, &map_, bus, status) {
  bus->Every(kTimerPeriod, [this] {
    requests_.SetShare(frames_.side_share());
    map_.PublishAndSaveIfDue(frames_.side_share());
    map_.Repeat();
    map_.ReportMemoryIfDue();
  });
}

void MapServer::Run() {
  while (!bus_.stop_requested()) {
    bus_.Spin(frames_.has_ready() ? 0 : 0.1);
    // Spin has received all frames that had arrived.
    if (const Result<bool> mapped = frames_.MapNext(); !mapped)
      LogWarningRateLimited("frame", mapped.error().message);
  }
}

}  // namespace vismap
