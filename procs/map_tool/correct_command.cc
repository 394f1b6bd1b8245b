#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "base/format.h"
#include "base/printable.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/pose_file.h"
#include "runtime/clock.h"
#include "wire/pose_correction.h"

// The subcommand `correct` of vismap-map.

namespace vismap {
namespace {

/// Sends the correction once and waits for what became of it.
Result<std::string> SendCorrection(Bus& bus, const PoseCorrection& correction, double timeout) {
  pose_correction_t message = Encode(correction);
  message.utime = message.request_id = WallUtime();
  std::optional<map_reply_t> answer;
  bus.Subscribe<map_reply_t>(kMapReplyChannel, [&](const map_reply_t& reply) {
    if (reply.requester == bus.source() && reply.request_id == message.request_id) answer = reply;
  });
  if (!bus.Publish(kPoseCorrectionChannel, message))
    return Fail("the correction could not be sent on " + bus.url());
  const double give_up = MonotonicSeconds() + timeout;
  while (!answer && !bus.stop_requested() && MonotonicSeconds() < give_up) bus.Spin(0.1);
  if (!answer) {
    return Fail("no answer to the correction within " + FormatDuration(timeout) + " on " +
                bus.url() +
                "; the map server may still be making the map (see --timeout), or does not run on "
                "this bus");
  }
  const std::string sentence = PrintableText(answer->message);
  if (!answer->ok) return Fail("the server refused the correction: " + sentence);
  return sentence;
}

}  // namespace

Outcome RunCorrect(const MapToolArguments& arguments, ProcessContext& context) {
  if (arguments.map != kLive) {
    return ExitWith(ExitCode::kUsage,
                    "only the map of a running server can be corrected, since it has the frames; "
                    "give 'live' as the map");
  }
  PoseCorrection correction{CameraId{arguments.camera_id}, arguments.interpolate, {}};
  Result<std::vector<PoseAtTime>> poses = ReadTumTrajectory(arguments.poses);
  if (!poses) return ExitWith(ExitCode::kUnreadable, poses.error().message);
  correction.poses = std::move(*poses);
  // The pid in the name makes it unique, so that each caller gets its own answer.
  const auto bus = OpenBus(context.options, context.options.name + "-" + std::to_string(getpid()),
                           &context.stop);
  if (!bus) return ExitWith(ExitCode::kFailed, bus.error().message);
  const Result<std::string> done = SendCorrection(**bus, correction, arguments.timeout);
  if (!done) return ExitWith(ExitCode::kFailed, done.error().message);
  std::printf("%s\n", done->c_str());
  return {};
}

}  // namespace vismap
