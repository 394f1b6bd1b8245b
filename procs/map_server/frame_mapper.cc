#include "map_server/frame_mapper.h"

#include <optional>

#include "base/format.h"
#include "geometry/prepare_depth.h"
#include "map/far_parts.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

// What every commit of a frame says, integrated or not.
frame_commit_t CommitOf(const segmented_frame_t& message, const MapSession& session) {
  frame_commit_t commit{};
  commit.utime = message.frame.utime;
  commit.camera_id = message.frame.camera_id;
  commit.frame_number = message.frame.frame_number;
  commit.map_id = session.metadata().map_id;
  commit.revision = session.map().revision;
  commit.had_detections = message.had_detections;
  commit.input_digest = DigestInput(message);
  return commit;
}

constexpr double kTrimPeriod = 0.5;  // [s]
constexpr double kFarPeriod = 2;     // [s]
constexpr size_t kNewestKept = 2;    // ready frames that are kept with Overload::kNewest
constexpr double kToldLag = 2;       // a larger one is a finding [s]

HoldLimits LimitsOf(const MapServerOptions& options) {
  HoldLimits limits;
  limits.max_bytes = static_cast<size_t>(options.queue_mb) * kMegabyte;
  limits.max_wait_s = options.max_wait_s;
  return limits;
}

}  // namespace

FrameMapper::FrameMapper(LiveMap* map, const VismapConfig& config, Bus* bus, Status* status)
    : map_(*map),
      bus_(*bus),
      status_(*status),
      overload_(config.map_server.overload),
      limits_(LimitsOf(config.map_server)),
      intake_(limits_),
      check_({config.integration.min_range_m, config.integration.max_range_m}, status) {
  bus_.Subscribe<segmented_frame_t>(
      kSegmentedFrameChannel,
      [this](const segmented_frame_t& message) { return OnFrame(message); });
  bus_.Subscribe<process_status_t>(
      kStatusChannel, [this](const process_status_t& told) { lag_.Seen(told, MonotonicSeconds()); },
      Delivery::kUrgent);
  bus_.Every(kTrimPeriod, [this] {
    DropBeyondLimits();
    TellLag();
  });
  bus_.Every(kFarPeriod, [this] { TellFarParts(); });
}

bool FrameMapper::Contains(const FrameKey& frame) const {
  return map_.session().Contains(frame.camera_id, frame.utime);
}

Result<void> FrameMapper::OnFrame(const segmented_frame_t& message) {
  if (intake_.SetMap(map_.frames_id())) {
    ready_.clear();
    lag_.Clear();
  }
  check_.SetMap(map_.session().metadata().map_id);
  lag_.Seen(KeyOf(message.frame), MonotonicSeconds());
  intake_.Add(message, MonotonicSeconds());
  CollectReady();
  Result<void> mapped;
  while (overload_ == Overload::kLossless && has_ready()) {
    if (const Result<bool> one = MapNext(); !one) mapped = tl::unexpected(one.error());
  }
  DropBeyondLimits();
  return mapped;
}

void FrameMapper::CollectReady() {
  while (std::optional<segmented_frame_t> next = intake_.Next(map_.session()))
    ready_.push_back(std::move(*next));
  while (overload_ == Overload::kNewest && ready_.size() > kNewestKept) {
    status_.Count("frames_dropped");
    Skip(ready_.front(), "newer frames were ready (map_server.overload is NEWEST)");
    ready_.pop_front();
  }
}

Result<bool> FrameMapper::MapNext() {
  if (ready_.empty()) return false;
  segmented_frame_t message = std::move(ready_.front());
  ready_.pop_front();
  const FrameKey frame = KeyOf(message.frame);
  const Result<void> mapped = MapMessage(std::move(message));
  lag_.Done(frame);
  CollectReady();  // other frames may have waited for this one
  if (!mapped) return tl::unexpected(mapped.error());
  return true;
}

void FrameMapper::TellLag() {
  const double data = lag_.DataSeconds(), waited = lag_.WaitSeconds(MonotonicSeconds());
  status_.SetCounter("lag_ms", static_cast<int64_t>(data * 1e3));
  status_.SetCounter("lag_wait_ms", static_cast<int64_t>(waited * 1e3));
  std::optional<std::string> finding;
  behind_ = data > kToldLag && waited > kToldLag;
  if (behind_) {
    finding = "the map is " + FormatDuration(data) +
              " behind the camera; the oldest frame that is not in it has waited for " +
              FormatDuration(waited);
  }
  status_.SetFinding("lag", finding);
}

// What is far from the rest is left out of what is made of the whole map.
void FrameMapper::TellFarParts() {
  const FollowerPosition position{map_.session().metadata().map_id, map_.session().map().revision};
  if (position == far_parts_position_) return;
  far_parts_position_ = position;
  const FarParts far(map_.session().metadata().trajectory);
  status_.SetCounter("frames_far_away", far.frames());
  status_.SetFinding("far", far.Sentence());
}

std::string FrameMapper::Summary() const {
  const auto count = [&](const char* counter) { return FormatCount(status_.counter(counter)); };
  return "integrated " + FormatCount(status_.counter("frames_integrated"), "frame") +
         "; not integrated: " + count("frames_skipped") +
         " that could not be used or were dropped, " + count("frames_refused") +
         " beyond a limit, " + count("held_frames_dropped") + " whose predecessor did not come, " +
         count("frames_duplicate") + " twice, " +
         FormatCount(static_cast<int64_t>(intake_.waiting() + ready_.size())) + " still waiting";
}

void FrameMapper::DropBeyondLimits() {
  const DroppedFrames dropped = intake_.Trim(MonotonicSeconds());
  if (dropped.late > 0) {
    LogWarningRateLimited("late", FormatCount(dropped.late, "frame") +
                                      " dropped: the frame before did not come within " +
                                      FormatDuration(limits_.max_wait_s));
  }
  if (dropped.no_room > 0) {
    LogWarningRateLimited("no room",
                          FormatCount(dropped.no_room, "frame") + " dropped: more than " +
                              std::to_string(limits_.max_frames) + " frames or " +
                              FormatBytes(limits_.max_bytes) + " wait for the frames before them");
  }
  status_.Count("held_frames_dropped", dropped.late + dropped.no_room);
  status_.SetCounter("frames_held", static_cast<int64_t>(intake_.waiting()));
  status_.SetCounter("held_bytes", static_cast<int64_t>(intake_.waiting_bytes()));
}

Result<void> FrameMapper::MapMessage(segmented_frame_t message) {
  const Result<SegmentedFrame> frame =
      StageTimings(&status_).Measure("decoding", [&] { return DecodeAndFill(message); });
  if (!frame) {
    Skip(message, frame.error().message);
    return tl::unexpected(frame.error());
  }
  status_.Set(ProcessState::kRunning, map_.StatusMessage());
  const frame_commit_t commit = MapOrRefuse(message, *frame);
  bus_.Publish(kMapCommitChannel, commit);
  if (commit.status == frame_commit_t::STATUS_INTEGRATED)
    map_.KeepFrame(std::move(message), commit);
  map_.PublishAndSaveIfDue(side_share());
  return {};
}

frame_commit_t FrameMapper::MapOrRefuse(const segmented_frame_t& message,
                                        const SegmentedFrame& frame) {
  frame_commit_t commit = CommitOf(message, map_.session());
  if (Contains(KeyOf(message.frame))) {
    status_.Count("frames_duplicate");
    if (!map_.history().has_corrected_poses())  // else the same frame may come with its old pose
      check_.Duplicate(frame.frame.header, commit.input_digest, map_.session());
    commit.status = frame_commit_t::STATUS_DUPLICATE;
    commit.reason = "is in the map already";
    return commit;
  }
  const auto [association, delta] = map_.Integrate(frame);
  status_.SetCounter("map_bytes", static_cast<int64_t>(BytesOf(map_.session().map())));
  if (delta.blocks_left_out > 0) {
    status_.Count("blocks_left_out", delta.blocks_left_out);
    status_.SetFinding(
        "map limit", "the map has reached its limit of " +
                         std::to_string(map_.session().options().integration.max_map_mb) +
                         " MB (integration.max_map_mb): new space is left out, what the map has is "
                         "still updated");
  }
  if (!delta.refused.empty()) {
    Refuse(message, delta.refused, &commit);
    return commit;
  }
  status_.Count("frames_integrated");
  status_.Count("votes_evicted", delta.votes_evicted);
  if (frame.had_detections) status_.Count("frames_with_detections");
  CheckClock(KeyOf(message.frame));
  check_.Integrated(frame, message.frame.depth_unit_m, commit.input_digest);
  commit.status = frame_commit_t::STATUS_INTEGRATED;
  commit.revision = delta.revision;
  commit.digest = DigestFrame(map_.session().map(), association, delta);
  return commit;
}

// Messages carry the depth as it was measured; the segments were made of the depth within the
// limits and without holes.
Result<SegmentedFrame> FrameMapper::DecodeAndFill(const segmented_frame_t& message) const {
  Result<SegmentedFrame> frame = Decode(message);
  if (frame) PrepareDepth(map_.session().options().depth, &frame->frame);
  return frame;
}

// A frame that cannot be used gets a commit, too, so that its source does not wait for it.
void FrameMapper::Skip(const segmented_frame_t& message, const std::string& reason) {
  if (Contains(KeyOf(message.frame))) return;  // a usable copy of it came before
  status_.Count("frames_skipped");
  check_.Skipped(reason);
  frame_commit_t commit = CommitOf(message, map_.session());
  MarkSkipped(message, reason, &commit);
  bus_.Publish(kMapCommitChannel, commit);
}

// A frame that is right in itself, but beyond a limit.
void FrameMapper::Refuse(const segmented_frame_t& message, const std::string& reason,
                         frame_commit_t* commit) {
  status_.Count("frames_refused");
  check_.Skipped(reason);
  LogWarningRateLimited("refused", ToText(KeyOf(message.frame)) + " is not integrated: " + reason);
  MarkSkipped(message, reason, commit);
}

void FrameMapper::MarkSkipped(const segmented_frame_t& message, const std::string& reason,
                              frame_commit_t* commit) {
  intake_.Skip(KeyOf(message.frame));
  commit->status = frame_commit_t::STATUS_SKIPPED;
  commit->reason = reason;
}

void FrameMapper::CheckClock(const FrameKey& frame) {
  if (const std::optional<std::string> remark = clocks_.Check(frame))
    LogWarningRateLimited("clock", *remark);
  status_.SetCounter("frames_out_of_order", clocks_.out_of_order());
  status_.SetCounter("clock_jumps", clocks_.jumps());
}

}  // namespace vismap
