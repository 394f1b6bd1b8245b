#include "map_server/pose_corrections.h"

#include <algorithm>
#include <exception>
#include <span>

#include "base/format.h"
#include "base/spare_threads.h"
#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

// The last frames of a rebuild are integrated by the thread of the bus, which maps no other frame
// meanwhile: when there are so few of them, or after so many rounds of the other thread.
constexpr size_t kFewFrames = 4;
constexpr int kMostRounds = 8;

std::string FrameCount(size_t count) { return FormatCount(static_cast<int64_t>(count), "frame"); }

std::string Trouble(const FrameJournal& journal) {
  const std::optional<std::string> trouble = journal.trouble();
  return trouble ? "; " + *trouble : ", from which the oldest ones are dropped at its limit";
}

using FramesByKey = std::map<FrameKey, JournaledFrame>;

FramesByKey KeptFrames(const FrameJournal& journal) {
  FramesByKey kept;
  for (JournaledFrame& frame : journal.Frames()) kept.emplace(frame.key, std::move(frame));
  return kept;
}

// The frames of a camera that are in the map, with the poses that they should have.
std::vector<PoseAtTime> FramesOfCamera(CameraId camera, const MapMetadata& metadata,
                                       const FramesByKey& kept) {
  std::vector<PoseAtTime> frames;
  for (const CameraPose& pose : metadata.trajectory) {
    if (pose.camera_id != camera) continue;
    const auto frame = kept.find({camera, pose.utime});
    frames.push_back({pose.utime, frame == kept.end() ? pose.T_W_C : frame->second.T_W_C});
  }
  return frames;
}

// The new poses of all frames of a camera. `named`: those that are given, by time.
std::vector<Pose> NewPoses(std::span<const PoseAtTime> frames, std::span<const PoseAtTime> named,
                           bool interpolated) {
  if (interpolated) return InterpolateCorrections(frames, named);
  std::map<int64_t, Pose> given;
  for (const PoseAtTime& pose : named) given.emplace(pose.utime, pose.T_W_C);
  std::vector<Pose> poses;
  for (const PoseAtTime& frame : frames) {
    const auto found = given.find(frame.utime);
    poses.push_back(found == given.end() ? frame.T_W_C : found->second);
  }
  return poses;
}

std::set<InstanceId> Ids(const std::vector<ObjectSummary>& objects) {
  std::set<InstanceId> ids;
  for (const ObjectSummary& object : objects) {
    if (!object.discovered()) ids.insert(object.instance);
  }
  return ids;
}

}  // namespace

PoseCorrections::PoseCorrections(const MapServerOptions& options, LiveMap* map, Bus* bus,
                                 Status* status)
    : accepts_(options.accept_corrections), map_(*map), bus_(*bus), status_(*status), worker_(bus) {
  bus->Subscribe<pose_correction_t>(
      kPoseCorrectionChannel, [this](const pose_correction_t& message) { OnCorrection(message); });
}

void PoseCorrections::Reply(const Requester& requester, bool ok, const std::string& sentence,
                            const std::string& json) {
  map_reply_t reply{};
  reply.utime = WallUtime();
  reply.requester = requester.source;
  reply.request_id = requester.request_id;
  reply.ok = ok;
  reply.message = sentence;
  reply.map_id = map_.session().metadata().map_id;
  reply.revision = map_.session().map().revision;
  if (!json.empty()) reply.encoding = "json";
  reply.payload.assign(json.begin(), json.end());
  reply.payload_size = static_cast<int32_t>(reply.payload.size());
  status_.Count(ok ? "corrections_done" : "corrections_refused");
  const std::string text = "correction of poses from " + requester.source + ": " + sentence;
  ok ? LogInfo(text) : LogWarningRateLimited("correction", text);
  bus_.Publish(kMapReplyChannel, reply);
}

void PoseCorrections::ReplyAll(bool ok, const std::string& sentence, const std::string& json) {
  for (const Requester& requester : std::exchange(waiting_, {}))
    Reply(requester, ok, requester.sentence + sentence, json);
}

void PoseCorrections::OnCorrection(const pose_correction_t& message) {
  if (given_up_ && frames_id_ != map_.frames_id()) Abandon("the server got another map meanwhile");
  const Result<std::string> begun = Begin(message);
  const Requester requester{message.source, message.request_id, begun.value_or("")};
  if (!begun) return Reply(requester, false, begun.error().message);
  if (!given_up_) return Reply(requester, true, *begun + "the map has these poses already");
  waiting_.push_back(requester);
}

// Returns the start of the sentence for the answer.
Result<std::string> PoseCorrections::Begin(const pose_correction_t& message) {
  if (!accepts_) {
    return Fail(
        "this server takes no corrections of poses; start it with `map_server { "
        "accept_corrections: true frame_journal_mb: 1024 }`");
  }
  const Result<PoseCorrection> correction = Decode(message);
  if (!correction) return tl::unexpected(correction.error());
  Result<Change> change = FindChange(*correction);
  if (!change) return tl::unexpected(change.error());
  std::string sentence = FrameCount(change->named) + " named, " + FrameCount(change->poses.size()) +
                         " with another pose than before";
  if (change->unknown > 0)
    sentence += ", " + FrameCount(change->unknown) + " that the map does not have";
  sentence += "; ";
  if (change->poses.empty()) return sentence;

  if (const Result<void> started = Start(*change); !started) return tl::unexpected(started.error());
  return sentence;
}

Result<PoseCorrections::Change> PoseCorrections::FindChange(
    const PoseCorrection& correction) const {
  const FrameJournal* journal = map_.history().journal();
  if (journal == nullptr) return Fail(map_.history().why_off());
  const FramesByKey kept = map_.history().begun() ? KeptFrames(*journal) : FramesByKey();
  const std::vector<PoseAtTime> frames =
      FramesOfCamera(correction.camera_id, map_.session().metadata(), kept);
  std::vector<PoseAtTime> named;
  for (const PoseAtTime& pose : correction.poses) {
    if (map_.session().Contains(correction.camera_id, pose.utime)) named.push_back(pose);
  }
  if (named.empty()) {
    return Fail("the map has none of the " + FrameCount(correction.poses.size()) + " of camera " +
                std::to_string(Raw(correction.camera_id)));
  }
  const std::vector<Pose> poses = NewPoses(frames, named, correction.interpolated);
  Change change;
  change.named = named.size();
  change.unknown = correction.poses.size() - named.size();
  for (size_t i = 0; i < frames.size(); ++i) {
    const FrameKey key{correction.camera_id, frames[i].utime};
    if (poses[i].matrix() == frames[i].T_W_C.matrix()) continue;
    const auto frame = kept.find(key);
    if (frame == kept.end())
      return Fail(ToText(key) + " is not in the journal of frames" + Trouble(*journal));
    const Result<Pose> pose = MakePose(poses[i].matrix());
    if (!pose)
      return Fail(ToText(key) + " would get a pose that cannot be used: " + pose.error().message);
    const int64_t revision = frame->second.revision;
    change.first = change.poses.empty() ? revision : std::min(change.first, revision);
    change.poses.push_back({key, *pose});
    change.old_poses.emplace(key, frames[i].T_W_C);
  }
  return change;
}

// The frames of the map after this one, with the poses that they should have.
Result<std::vector<PoseCorrections::Frame>> PoseCorrections::FramesAfter(int64_t revision) const {
  const FrameJournal& journal = *map_.history().journal();
  const int64_t last = map_.session().map().revision;
  std::vector<Frame> frames;
  for (const JournaledFrame& frame : journal.Frames()) {
    if (frame.revision <= revision || frame.revision > last) continue;
    if (frame.revision != revision + 1 + static_cast<int64_t>(frames.size())) break;
    frames.push_back({frame.revision, frame.T_W_C});
  }
  const int64_t missing = revision + 1 + static_cast<int64_t>(frames.size());
  if (missing <= last) {
    return Fail("the journal of frames lacks frame " + std::to_string(missing) + " of the map" +
                Trouble(journal));
  }
  return frames;
}

Result<void> PoseCorrections::Start(const Change& change) {
  FrameHistory& history = map_.history();
  const std::shared_ptr<const MapSession> from = history.checkpoints().NewestBefore(change.first);
  if (!from) {
    return Fail("there is no copy of the map before frame " + std::to_string(change.first) +
                ", the first one whose pose changes");
  }
  const int64_t revision = from->map().revision;
  if (const auto frames = FramesAfter(revision); !frames) return tl::unexpected(frames.error());
  if (const Result<void> added = history.journal()->AddPoses(change.poses); !added)
    return Fail("the journal of frames cannot be written: " + added.error().message);
  for (const auto& [key, pose] : change.old_poses) old_poses_.emplace(key, pose);
  history.checkpoints().DropFrom(change.first);
  history.SetMapIsOutdated(true);
  GiveUp();
  given_up_ = std::make_shared<std::atomic<bool>>(false);
  frames_id_ = map_.frames_id();
  rounds_ = 0;
  start_ = MonotonicSeconds();
  StartRound(std::make_shared<Rebuild>(
      Rebuild{*from, history.checkpoints(), *FramesAfter(revision), given_up_}));
  return {};
}

void PoseCorrections::StartRound(const std::shared_ptr<Rebuild>& rebuild) {
  ++rounds_;
  status_.SetCounter("correction_frames_left", static_cast<int64_t>(rebuild->frames.size()));
  const auto work = [this, rebuild] {
    Integrate(rebuild.get());
    return true;
  };
  worker_.Start(work, [this, rebuild](bool) { EndRound(rebuild); });
}

void PoseCorrections::Integrate(Rebuild* rebuild) const {
  try {
    InSpareThreads([&] { IntegrateAll(rebuild); });
  } catch (const std::exception& error) {
    rebuild->error = Error{std::string("the map cannot be made: ") + error.what()};
  }
}

void PoseCorrections::IntegrateAll(Rebuild* rebuild) const {
  for (const Frame& frame : rebuild->frames) {
    if (*rebuild->given_up) return;
    const Result<segmented_frame_t> message = map_.history().journal()->Read(frame.revision);
    rebuild->checkpoints.AddIfDue(rebuild->session);
    Result<ReplayedFrame> replayed = message
                                         ? ReplayFrame(*message, frame.T_W_C, &rebuild->session)
                                         : Result<ReplayedFrame>(tl::unexpected(message.error()));
    if (!replayed) {
      rebuild->error = replayed.error();
      return;
    }
    rebuild->seen[frame.revision] = std::move(replayed->seen);
  }
}

void PoseCorrections::EndRound(const std::shared_ptr<Rebuild>& rebuild) {
  if (*rebuild->given_up) return;
  if (frames_id_ != map_.frames_id()) return Abandon("the server got another map meanwhile");
  if (rebuild->error) return Abandon(rebuild->error->message);
  Result<std::vector<Frame>> rest = FramesAfter(rebuild->session.map().revision);
  if (!rest) return Abandon(rest.error().message);
  rebuild->frames = std::move(*rest);
  if (rebuild->frames.size() > kFewFrames && rounds_ < kMostRounds) return StartRound(rebuild);
  Integrate(rebuild.get());
  if (rebuild->error) return Abandon(rebuild->error->message);
  Replace(rebuild.get());
}

void PoseCorrections::Replace(Rebuild* rebuild) {
  const std::set<InstanceId> old_objects = Ids(map_.publisher().FreshObjects(map_.session()));
  const SeenByFrame old_seen = map_.history().seen();
  std::shared_ptr<MapSession> old = map_.ReplaceByCorrected(std::move(rebuild->session));
  map_.history().SawAgain(std::move(rebuild->seen));
  const ObjectLinks links = LinkObjects({old_seen, old->map().labels, old_objects},
                                        {map_.history().seen(), map_.session().map().labels,
                                         Ids(map_.publisher().FreshObjects(map_.session()))});
  worker_.Start([old = std::move(old)] { return true; }, [](bool) {});  // frees it
  map_.history().checkpoints() = std::move(rebuild->checkpoints);
  map_.history().SetMapIsOutdated(false);
  old_poses_.clear();
  given_up_.reset();
  status_.SetCounter("correction_frames_left", 0);
  ReplyAll(true,
           "they are in map " + map_.session().metadata().map_id + " now, which took " +
               FormatDuration(MonotonicSeconds() - start_) + "; " + Sentence(links),
           LinksJson(links));
}

// The map stays as it is, and the journal gets its poses again.
void PoseCorrections::Abandon(const std::string& reason) {
  GiveUp();
  given_up_.reset();
  status_.SetCounter("correction_frames_left", 0);
  if (frames_id_ == map_.frames_id()) {
    std::vector<JournaledPose> poses;
    for (const auto& [key, pose] : old_poses_) poses.push_back({key, pose});
    const Result<void> added = map_.history().journal()->AddPoses(std::move(poses));
    if (!added) LogWarning("the journal of frames cannot be written: " + added.error().message);
    map_.history().SetMapIsOutdated(false);
  }
  old_poses_.clear();
  ReplyAll(false, "the map stays as it is: " + reason);
}

void PoseCorrections::GiveUp() {
  if (given_up_) *given_up_ = true;
}

void PoseCorrections::Stop() {
  if (!given_up_) return;
  GiveUp();
  worker_.Finish();
  ReplyAll(false,
           "the server stops before the map is made; with map_server.recover, that is done at the "
           "next start");
}

}  // namespace vismap
