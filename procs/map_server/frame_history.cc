#include "map_server/frame_history.h"

#include <algorithm>
#include <utility>

#include "base/format.h"
#include "geometry/prepare_depth.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

constexpr size_t kMostSeenFrames = 20000;
constexpr FrameKey kNoFrame{CameraId{-1}, 0};

std::filesystem::path JournalFolder(const MapServerOptions& options) {
  if (!options.frame_journal.empty()) return options.frame_journal;
  return options.save_on_exit + ".frames";
}

bool SamePose(const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); }

// The pose of a message that was decoded before.
Pose PoseOf(const segmented_frame_t& message) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  return MakePose(Eigen::Map<const RowMajor>(message.frame.T_W_C)).value_or(Pose::Identity());
}

// Whether a map can be made of these frames alone.
bool AreComplete(const std::vector<JournaledFrame>& frames) {
  return frames.front().revision == 1 &&
         frames.back().revision == static_cast<int64_t>(frames.size());
}

FrameKey KeyOfPose(const CameraPose& pose) { return {pose.camera_id, pose.utime}; }

}  // namespace

Result<ReplayedFrame> ReplayFrame(const segmented_frame_t& message, const Pose& T_W_C,
                                  MapSession* session) {
  const FrameKey key = KeyOf(message.frame);
  if (session->Contains(key.camera_id, key.utime))
    return Fail(ToText(key) + " is in the map already");
  Result<SegmentedFrame> frame = Decode(message);
  if (!frame) return tl::unexpected(frame.error());
  frame->frame.header.T_W_C = T_W_C;
  PrepareDepth(session->options().depth, &frame->frame);
  MappedFrame mapped = MapFrame(*frame, session);
  if (!mapped.delta.refused.empty())
    return Fail(ToText(key) + " is refused: " + mapped.delta.refused);
  std::vector<SeenSegment> seen = SeenIn(*frame, mapped.association);
  return ReplayedFrame{std::move(mapped), std::move(seen)};
}

FrameHistory::FrameHistory(const VismapConfig& config, Status* status)
    : options_(config),
      status_(status),
      checkpoints_(config.map_server.checkpoint_frames,
                   static_cast<size_t>(config.map_server.checkpoint_mb) << 20),
      keeps_copies_(config.map_server.accept_corrections) {
  if (config.map_server.frame_journal_mb == 0) return;
  FrameJournalLimits limits;
  limits.max_bytes = static_cast<uint64_t>(config.map_server.frame_journal_mb) << 20;
  auto journal = FrameJournal::Open(JournalFolder(config.map_server), limits);
  if (journal) {
    journal_ = std::move(*journal);
    why_off_.clear();
    status_->SetFindings("damaged journal", journal_->remarks());
  } else {
    why_off_ = "there is no journal of frames: " + journal.error().message;
    status_->SetFinding("frame journal", why_off_);
  }
}

void FrameHistory::BeginMap() {
  checkpoints_.Clear();
  seen_.clear();
  outdated_ = false;
  begun_ = true;
  if (journal_) journal_->BeginMap();
}

void FrameHistory::BeforeFrame(const MapSession& session) {
  if (!journal_) return;
  if (!begun_) BeginMap();
  KeepCopyIfDue(session);
}

void FrameHistory::KeepCopyIfDue(const MapSession& session) {
  if (keeps_copies_ && !outdated_) checkpoints_.AddIfDue(session);
}

void FrameHistory::Saw(int64_t revision, std::vector<SeenSegment> seen) {
  if (!journal_ || !keeps_copies_) return;
  seen_.erase(seen_.lower_bound(revision), seen_.end());
  seen_.emplace(revision, std::move(seen));
  if (seen_.size() > kMostSeenFrames) seen_.erase(seen_.begin());
}

void FrameHistory::SawAgain(SeenByFrame seen) {
  for (auto& [revision, segments] : seen) {
    const auto known = seen_.find(revision);
    if (known != seen_.end()) known->second = std::move(segments);
  }
}

void FrameHistory::AddFrame(segmented_frame_t message, const frame_commit_t& commit,
                            const MapSession& session) {
  if (!journal_) return;
  const std::vector<CameraPose>& trajectory = session.metadata().trajectory;
  JournaledFrame frame;
  frame.key = KeyOf(message.frame);
  frame.revision = session.map().revision;
  frame.T_W_C = trajectory.back().T_W_C;
  frame.previous = trajectory.size() > 1 ? KeyOfPose(trajectory.end()[-2]) : kNoFrame;
  frame.digest = commit.digest;
  journal_->Add(std::move(frame), std::move(message));
  ShowStatus();
}

void FrameHistory::ShowStatus() {
  status_->SetCounter("journal_frames", static_cast<int64_t>(journal_->size()));
  status_->SetCounter("journal_bytes", static_cast<int64_t>(journal_->bytes()));
  status_->SetFinding("frame journal", journal_->trouble());
}

// Whether the frames of the journal are the last ones of the map, with the same poses, or follow
// them.
bool FrameHistory::Agrees(const MapSession& saved,
                          const std::vector<JournaledFrame>& frames) const {
  const std::vector<CameraPose>& trajectory = saved.metadata().trajectory;
  const auto revision = static_cast<int64_t>(trajectory.size());
  if (revision != saved.map().revision) return false;
  const int64_t before = frames.front().revision - 1;
  if (before < 0 || before > revision) return false;
  const FrameKey last =
      before == 0 ? kNoFrame : KeyOfPose(trajectory[static_cast<size_t>(before - 1)]);
  if (frames.front().previous != last) return false;
  return std::all_of(frames.begin(), frames.end(), [&](const JournaledFrame& frame) {
    if (frame.revision > revision) return true;
    const CameraPose& pose = trajectory[static_cast<size_t>(frame.revision - 1)];
    return KeyOfPose(pose) == frame.key && SamePose(pose.T_W_C, frame.T_W_C);
  });
}

// Until one is missing.
void FrameHistory::TakeFrames(const std::vector<JournaledFrame>& frames, ContinuedMap* map) {
  bool as_before = true;  // none has another pose than it came with
  for (const JournaledFrame& frame : frames) {
    if (frame.revision <= map->session.map().revision) continue;
    const auto rest = static_cast<int64_t>(&frames.back() - &frame) + 1;
    const auto stop = [&](const std::string& reason) {
      map->remarks.push_back(FormatCount(rest, "frame") + " of the journal, from " +
                             ToText(frame.key) + " on, cannot be integrated again: " + reason);
    };
    if (frame.revision != map->session.map().revision + 1)
      return stop("those before are missing in it");
    const Result<segmented_frame_t> message = journal_->Read(frame.revision);
    if (!message) return stop(message.error().message);
    KeepCopyIfDue(map->session);
    Result<ReplayedFrame> replayed = ReplayFrame(*message, frame.T_W_C, &map->session);
    if (!replayed) return stop(replayed.error().message);
    const MappedFrame& mapped = replayed->mapped;
    Saw(frame.revision, std::move(replayed->seen));
    map->taken.push_back(frame.key);
    as_before = as_before && SamePose(PoseOf(*message), frame.T_W_C);
    if (as_before && !map->made_anew && frame.digest.size() == 32 &&
        DigestFrame(map->session.map(), mapped.association, mapped.delta) != frame.digest)
      status_->Count("frames_recovered_differently");
  }
}

ContinuedMap FrameHistory::Continue(MapSession saved, MapMetadata empty) {
  begun_ = true;
  ContinuedMap map{std::move(saved), {}, false, {}};
  if (!journal_) return map;
  const std::vector<JournaledFrame> frames = journal_->Frames();
  if (frames.empty()) return map;
  const bool agrees = Agrees(map.session, frames), complete = AreComplete(frames);
  if (agrees || complete) {
    if (complete && keeps_copies_)
      checkpoints_.Add(std::make_shared<const MapSession>(options_, empty));
    if (!agrees) {
      if (map.session.map().revision > 0)
        map.remarks.push_back(
            "the saved map is not the one that the journal of frames is of, or has other poses; "
            "the map was made from the journal");
      map.session = MapSession(options_, std::move(empty));
      map.made_anew = true;
    }
    TakeFrames(frames, &map);
  } else {
    const Result<std::filesystem::path> aside = journal_->BeginMapAside();
    map.remarks.push_back(
        "the journal of frames is of another map than the saved one or has other poses, and lacks "
        "frames that it would need to be used alone; " +
        (aside ? "it is in " + aside->string() + " now" : aside.error().message));
  }
  ShowStatus();
  return map;
}

}  // namespace vismap
