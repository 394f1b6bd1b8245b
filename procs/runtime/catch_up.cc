#include "runtime/catch_up.h"

#include <vismap/map_request_t.hpp>

#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kRepeatPeriod = 2.0;  // [s]
}  // namespace

void CatchUp::Request(const FollowerPosition& position) {
  if (MonotonicSeconds() < next_request_) return;
  next_request_ = MonotonicSeconds() + kRepeatPeriod;
  map_request_t request{};
  request.utime = request.request_id = WallUtime();
  request.verb = verb_;
  request.argument = ToText(position);
  bus_->Publish(kMapRequestChannel, request);
}

}  // namespace vismap
