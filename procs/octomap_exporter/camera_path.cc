#include "octomap_exporter/camera_path.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vismap/map_request_t.hpp>

#include "base/json_text.h"
#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {

namespace {

constexpr double kRepeatPeriod = 2;         // of a request without an answer [s]
constexpr size_t kMostPositions = 4000000;  // 100 MB

/// Reads [[x, y, z], ...].
Result<std::vector<Eigen::Vector3d>> ReadPositions(const std::vector<uint8_t>& payload) {
  const Result<nlohmann::json> json =
      ParseJson({reinterpret_cast<const char*>(payload.data()), payload.size()});
  if (!json) return tl::unexpected(json.error());
  std::vector<Eigen::Vector3d> positions;
  if (!json->is_array()) return Fail("expected an array, found " + DescribeJson(*json));
  for (const nlohmann::json& p : *json) {
    const bool three = p.is_array() && p.size() == 3 &&
                       std::all_of(p.begin(), p.end(), [](const auto& x) { return x.is_number(); });
    if (!three) return Fail("expected arrays of three numbers, found " + DescribeJson(p));
    positions.emplace_back(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  }
  return positions;
}

}  // namespace

CameraPath::CameraPath(bool wanted, double patience, Bus* bus)
    : wanted_(wanted), patience_(patience), bus_(bus) {
  if (!wanted_) return;
  bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                               [this](const map_reply_t& reply) { return OnReply(reply); });
}

void CameraPath::Request(const FollowerPosition& position) {
  if (!wanted_ || position.revision < 0) return;
  if (position.map_id != map_id_) {
    map_id_ = position.map_id;
    positions_W_.clear();
    request_id_ = 0;
    next_request_ = 0;
    missing_since_.reset();
  }
  const double now = MonotonicSeconds();
  if (static_cast<int64_t>(positions_W_.size()) >= position.revision) {
    missing_since_.reset();
    return;
  }
  if (!missing_since_) missing_since_ = now;
  if (now < next_request_ || positions_W_.size() >= kMostPositions) return;
  next_request_ = now + kRepeatPeriod;
  map_request_t request{};
  request.utime = request.request_id = request_id_ = WallUtime();
  request.map_id = map_id_;
  request.verb = "frames";
  request.argument = "positions=" + std::to_string(positions_W_.size());
  request.unknown = map_request_t::UNKNOWN_DEFAULT;
  bus_->Publish(kMapRequestChannel, request);
}

bool CameraPath::IsAwaited() const {
  return missing_since_ && MonotonicSeconds() < *missing_since_ + patience_;
}

Result<void> CameraPath::OnReply(const map_reply_t& reply) {
  const bool ours = request_id_ != 0 && reply.request_id == request_id_ && reply.ok &&
                    reply.requester == bus_->source() && reply.map_id == map_id_;
  if (!ours) return {};
  request_id_ = 0;
  next_request_ = 0;
  missing_since_.reset();
  const Result<std::vector<Eigen::Vector3d>> positions = ReadPositions(reply.payload);
  if (!positions) return Fail("positions of the camera: " + positions.error().message);
  positions_W_.insert(positions_W_.end(), positions->begin(), positions->end());
  return {};
}

}  // namespace vismap
