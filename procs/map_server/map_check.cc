#include "map_server/map_check.h"

#include <algorithm>

namespace vismap {
namespace {

constexpr int64_t kLongestPeriod = 512;  // frames between two judgements, each of which takes time

// Whether the map has this camera's frame of this time with the same pose.
bool HasSamePose(const MapSession& session, const FrameHeader& header) {
  const auto& trajectory = session.metadata().trajectory;
  // The frame was most likely sent shortly before.
  const auto found = std::find_if(trajectory.rbegin(), trajectory.rend(), [&](const auto& pose) {
    return pose.camera_id == header.camera_id && pose.utime == header.utime;
  });
  return found != trajectory.rend() && found->T_W_C.isApprox(header.T_W_C, 1e-9);
}

}  // namespace

void MapCheck::SetMap(const std::string& map_id) {
  if (map_id == map_id_) return;
  map_id_ = map_id;
  sequence_ = SequenceCheck(limits_);
  frames_ = 0;
  next_check_ = kFirstCheck;
  left_out_ = {};
  last_digest_.clear();
  status_->SetFindings("sequence", {});
  status_->SetFindings("left out", {});
}

void MapCheck::Integrated(const SegmentedFrame& frame, double depth_unit_m,
                          const std::string& input_digest) {
  sequence_.Add(frame, depth_unit_m);
  last_ = KeyOf(frame.frame.header);
  last_digest_ = input_digest;
  if (++frames_ < next_check_) return;
  status_->SetFindings("sequence", sequence_.Findings());
  if (frames_ % kLongestPeriod == 0) sequence_.ForgetDepth();
  next_check_ += std::min(next_check_, kLongestPeriod);
}

void MapCheck::Skipped(const std::string& reason) {
  left_out_.Add(reason);
  UpdateLeftOut();
}

void MapCheck::Duplicate(const FrameHeader& header, const std::string& input_digest,
                         const MapSession& session) {
  const bool same = KeyOf(header) == last_ && !last_digest_.empty() ? input_digest == last_digest_
                                                                    : HasSamePose(session, header);
  if (same) return;
  status_->Count("frames_with_used_utime");
  left_out_.Add("another frame of " + ToText(KeyOf(header)) +
                " is in the map already; every frame of a camera needs a utime of its own");
  UpdateLeftOut();
}

void MapCheck::UpdateLeftOut() {
  status_->SetFinding("left out", LeftOutText(left_out_, frames_ + left_out_.total()));
}

}  // namespace vismap
