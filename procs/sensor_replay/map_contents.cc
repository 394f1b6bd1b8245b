#include "sensor_replay/map_contents.h"

#include <nlohmann/json.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "base/json_text.h"
#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr double kRepeatPeriod = 1.0;  // [s]
// Of a list of frames: a million of them. As JSON it takes about 15 times as much memory.
constexpr size_t kMaxPayload = 32 * kMegabyte;
}  // namespace

MapContents::MapContents(Bus* bus, const Peers* peers) : bus_(bus), peers_(peers) {
  bus_->Subscribe<map_reply_t>(kMapReplyChannel, [this](const map_reply_t& reply) {
    if (reply.payload.size() > kMaxPayload) return Result<void>();
    return OnReply(reply.requester, reply.request_id, reply.ok,
                   {reply.payload.begin(), reply.payload.end()});
  });
}

bool MapContents::ServerRestarted() {
  bool restarted = false;
  for (const auto& [source, peer] : peers_->all()) {
    if (peer.process != "map-server") continue;
    const auto [known, first] = start_utimes_.try_emplace(source, peer.start_utime);
    restarted = restarted || known->second != peer.start_utime;
    known->second = peer.start_utime;
  }
  return restarted;
}

void MapContents::Request() {
  const double now = MonotonicSeconds();
  if (requested_ && now - request_time_ < kRepeatPeriod) return;
  requested_ = true;
  request_time_ = now;
  map_request_t request{};
  request.utime = WallUtime();
  request.request_id = request_id_ = request.utime;
  request.verb = "frames";
  request.argument = "poses";
  bus_->Publish(kMapRequestChannel, request);
}

Result<void> MapContents::OnReply(const std::string& requester, int64_t request_id, bool ok,
                                  const std::string& payload) {
  if (!requested_ || requester != bus_->source() || request_id != request_id_ || !ok) return {};
  const Result<nlohmann::json> json = ParseJson(payload);
  if (!json || !json->is_array()) return Fail("answer to 'frames': expected a JSON array");
  std::map<FrameKey, std::string> frames;
  for (const auto& frame : *json) {
    if (!frame.is_array() || frame.size() != 3 || !frame[0].is_number_integer() ||
        !frame[1].is_number_integer() || !frame[2].is_string()) {
      return Fail("answer to 'frames': expected [camera_id, utime, pose], found " +
                  DescribeJson(frame));
    }
    frames[{CameraId{frame[0].get<int32_t>()}, frame[1].get<int64_t>()}] =
        frame[2].get<std::string>();
  }
  frames_ = std::move(frames);
  answered_ = true;
  return {};
}

bool MapContents::ConsumeAnswer() {
  if (!answered_) return false;
  answered_ = requested_ = false;
  return true;
}

}  // namespace vismap
