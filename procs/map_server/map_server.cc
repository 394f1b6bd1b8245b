#include "map_server/map_server.h"

#include "settings/settings.h"

namespace vismap {

namespace {
constexpr double kTimerPeriod = 0.5;  // [s]
}  // namespace

MapServer::MapServer(const VismapConfig& config, Bus* bus, Status* status)
    : map_(config, bus, status),
      frames_(&map_, config, bus, status),
      requests_(config, &map_, bus, status) {
  bus->Every(kTimerPeriod, [this] {
    map_.PublishAndSaveIfDue();
    map_.Repeat();
  });
}

}  // namespace vismap
