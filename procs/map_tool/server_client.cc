#include "map_tool/server_client.h"

#include <optional>

#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kAskAgain = 3.0;  // [s]
}  // namespace

Result<map_reply_t> Ask(Bus& bus, map_request_t request, double timeout) {
  request.utime = WallUtime();
  request.request_id = request.utime;
  std::optional<map_reply_t> answer;
  bus.Subscribe<map_reply_t>(kMapReplyChannel, [&](const map_reply_t& reply) {
    if (reply.requester == bus.source() && reply.request_id == request.request_id) answer = reply;
  });
  const double give_up = MonotonicSeconds() + timeout;
  double ask_again = 0;
  while (!answer && !bus.stop_requested() && MonotonicSeconds() < give_up) {
    if (MonotonicSeconds() >= ask_again) {
      bus.Publish(kMapRequestChannel, request);
      ask_again = MonotonicSeconds() + kAskAgain;
    }
    bus.Spin(0.1);
  }
  if (!answer) {
    return Fail("no answer to '" + request.verb + "' within " +
                std::to_string(static_cast<int>(timeout)) + " s at " + bus.url() +
                ": is vismap-map-server running on this bus?");
  }
  if (!answer->ok) return Fail("the server refused '" + request.verb + "': " + answer->message);
  return *answer;
}

}  // namespace vismap
