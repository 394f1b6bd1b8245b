#include "map_tool/server_client.h"

#include <optional>

#include "base/format.h"
#include "base/printable.h"
#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kRepeatPeriod = 3.0;  // [s]
}  // namespace

Result<map_reply_t> SendRequest(Bus& bus, map_request_t request, double timeout) {
  request.utime = WallUtime();
  request.request_id = request.utime;
  std::optional<map_reply_t> answer;
  bus.Subscribe<map_reply_t>(kMapReplyChannel, [&](const map_reply_t& reply) {
    if (reply.requester == bus.source() && reply.request_id == request.request_id) answer = reply;
  });
  const double give_up = MonotonicSeconds() + timeout;
  double next_attempt = 0;
  while (!answer && !bus.stop_requested() && MonotonicSeconds() < give_up) {
    if (MonotonicSeconds() >= next_attempt) {
      bus.Publish(kMapRequestChannel, request);
      next_attempt = MonotonicSeconds() + kRepeatPeriod;
    }
    bus.Spin(0.1);
  }
  if (!answer) {
    return Fail("no answer to the request '" + request.verb + "' within " +
                FormatDuration(timeout) + " on " + bus.url() +
                "; check with vismap-doctor that vismap-map-server is running on this bus");
  }
  answer->message = PrintableText(answer->message);
  if (!answer->ok)
    return Fail("the server rejected the request '" + request.verb + "': " + answer->message);
  return *answer;
}

}  // namespace vismap
