#include "bridge/source_sides.h"

namespace vismap {
namespace {

constexpr double kMoveAfter = 30;  // [s]
constexpr size_t kMaxSources = 4096;

}  // namespace

bool SourceSides::LivesOn(BridgeSide side, const std::string& source, double now) {
  const auto known = homes_.find(source);
  if (known == homes_.end()) {
    if (homes_.size() >= kMaxSources) return false;
    homes_[source] = {side, now};
    return true;
  }
  Home& home = known->second;
  if (home.side != side && now - home.last_heard < kMoveAfter) return false;
  home = {side, now};
  return true;
}

}  // namespace vismap
