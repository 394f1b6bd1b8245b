#include "runtime/catch_up.h"

#include <vismap/map_request_t.hpp>

#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kAskAgain = 2.0;  // [s]
}  // namespace

void CatchUp::Ask(const FollowerPosition& position) {
  if (MonotonicSeconds() < due_) return;
  due_ = MonotonicSeconds() + kAskAgain;
  map_request_t request{};
  request.utime = request.request_id = WallUtime();
  request.verb = verb_;
  request.argument = ToText(position);
  bus_->Publish(kMapRequestChannel, request);
}

}  // namespace vismap
