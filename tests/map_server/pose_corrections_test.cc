#include "map_server/pose_corrections.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "map_server/map_server.h"
#include "map_server/small_frames.h"
#include "runtime/clock.h"
#include "session/map_frame.h"
#include "simulation/synthetic_dataset.h"
#include "support/temp_folder.h"
#include "wire/map_follower.h"

// A whole map server, on a bus of its own, whose frames come with poses that are not right.

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing_support::MemoryBus;

constexpr int kRoomFrames = 12;
constexpr char kSource[] = "test";  // of MemoryBus

/// The frames of a small room, as a camera sees them.
struct RoomFrames {
  explicit RoomFrames(double pose_noise) {
    SyntheticOptions options;
    options.frames = kRoomFrames;
    options.width = 80;
    options.pose_noise = pose_noise;
    const auto dataset = MakeSyntheticDataset(options, {});
    const auto source = MakeSyntheticDetections(options);
    for (size_t i = 0; i < dataset->size(); ++i) {
      sensor.push_back(*dataset->Read(i));
      detections.push_back(*source->ForFrame(dataset->Header(i)));
    }
  }
  const FrameHeader& header(size_t i) const { return sensor[i].header; }
  segmented_frame_t Message(size_t i, const SegmentationStageOptions& options) const {
    return Encode(SegmentFrame(*DecodeFrame(sensor[i]), &detections[i], options),
                  Encode(sensor[i]));
  }

  std::vector<SensorFrame> sensor;
  std::vector<DetectionSet> detections;
};

/// One run of a server.
class RunningServer {
 public:
  explicit RunningServer(const VismapConfig& config) : server_(config, bus_.get(), &status_) {
    bus_->Subscribe<map_reply_t>(kMapReplyChannel,
                                 [this](const map_reply_t& reply) { replies.push_back(reply); });
    bus_->Subscribe<frame_commit_t>(kMapCommitChannel, [this](const frame_commit_t& commit) {
      if (commit.status == frame_commit_t::STATUS_INTEGRATED) ++integrated;
    });
    bus_->Subscribe<map_delta_t>(kMapDeltaChannel, [this](const map_delta_t& message) {
      if (const Result<MapUpdate> update = Decode(message)) follower.Apply(*update);
    });
  }
  void Deliver() {
    while (bus_->Spin(0)) {
    }
  }
  void Send(const segmented_frame_t& message) {
    bus_->Publish(kSegmentedFrameChannel, message);
    Deliver();
  }
  void Send(pose_correction_t correction, int64_t request_id) {
    correction.request_id = request_id;
    bus_->Publish(kPoseCorrectionChannel, correction);
    Deliver();
  }
  /// The answer to a correction.
  map_reply_t WaitForReply(int64_t request_id) {
    const double deadline = MonotonicSeconds() + 60;
    while (MonotonicSeconds() < deadline) {
      for (const map_reply_t& reply : replies) {
        if (reply.request_id == request_id && reply.requester == kSource) {
          Deliver();
          return reply;
        }
      }
      bus_->Spin(0.01);
    }
    ADD_FAILURE() << "no answer to correction " << request_id;
    return {};
  }
  std::string Hash() { return HashMap(server_.map().session().map()); }
  MapServer& server() { return server_; }
  Status& status() { return status_; }

  std::vector<map_reply_t> replies;
  int integrated = 0;
  MapFollower follower;

 private:
  std::unique_ptr<Bus> bus_ = MemoryBus();
  Status status_{bus_.get(), "map-server"};
  MapServer server_;
};

struct CorrectedRoom {
  explicit CorrectedRoom(const std::filesystem::path& folder) {
    config_.grid = testing_support::CoarseMap().grid;
    config_.map_server.save_on_exit = folder / "map.vismap";
    config_.map_server.recover = true;
    config_.map_server.frame_journal_mb = 64;
    config_.map_server.accept_corrections = true;
    config_.map_server.checkpoint_frames = 3;
    DeriveOptions(&config_);
  }

  /// The hash of the map of the first frames, with these poses.
  std::string HashOf(size_t count, const std::vector<Pose>& poses) const {
    MapSession session(config_, {});
    for (size_t i = 0; i < count; ++i) {
      RgbdFrame frame = *DecodeFrame(came_.sensor[i]);
      frame.header.T_W_C = poses[i];
      MapFrame(std::move(frame), &came_.detections[i], config_, &session);
    }
    return HashMap(session.map());
  }
  std::vector<Pose> PosesOf(const RoomFrames& frames) const {
    std::vector<Pose> poses;
    for (const SensorFrame& frame : frames.sensor) poses.push_back(frame.header.T_W_C);
    return poses;
  }
  /// The right poses of frames in [from, to).
  PoseCorrection Right(size_t from, size_t to, bool interpolated = false) const {
    PoseCorrection correction{came_.header(0).camera_id, interpolated, {}};
    for (size_t i = from; i < to; ++i)
      correction.poses.push_back({right_.header(i).utime, right_.header(i).T_W_C});
    return correction;
  }
  /// A follower of MAP_DELTA has the map of the server.
  static void ExpectFollowed(RunningServer* run) {
    const MapSession& session = run->server().map().session();
    EXPECT_EQ(run->follower.position().map_id, session.metadata().map_id);
    EXPECT_EQ(run->follower.position().revision, session.map().revision);
    ASSERT_TRUE(run->follower.occupancy());
    EXPECT_EQ(run->follower.occupancy()->Digest(),
              run->server().map().publisher().occupancy().Digest());
  }

  segmented_frame_t Message(size_t i) const { return came_.Message(i, config_); }

  VismapConfig config_;
  RoomFrames came_{0.03}, right_{0};
};

class CorrectedMap : public ::testing::Test, protected CorrectedRoom {
 protected:
  CorrectedMap() : CorrectedMap(std::make_shared<TempFolder>()) {}
  explicit CorrectedMap(const std::shared_ptr<TempFolder>& folder)
      : CorrectedRoom(folder->path()), folder_(folder) {}

  std::shared_ptr<TempFolder> folder_;
};

TEST_F(CorrectedMap, IsThatOfTheSameFramesWithTheRightPoses) {
  RunningServer run(config_);
  for (size_t i = 0; i < kRoomFrames; ++i) run.Send(Message(i));
  ASSERT_EQ(run.integrated, kRoomFrames);
  const std::string drifted = HashOf(kRoomFrames, PosesOf(came_));
  const std::string right = HashOf(kRoomFrames, PosesOf(right_));
  ASSERT_NE(drifted, right);
  EXPECT_EQ(run.Hash(), drifted);
  const std::string old_id = run.server().map().session().metadata().map_id;

  run.Send(Encode(Right(0, kRoomFrames)), 5);
  const map_reply_t reply = run.WaitForReply(5);
  EXPECT_TRUE(reply.ok) << reply.message;
  EXPECT_THAT(reply.message, HasSubstr("12 frames named, 12 frames with another pose"));
  EXPECT_EQ(run.Hash(), right);
  const MapMetadata& metadata = run.server().map().session().metadata();
  EXPECT_NE(metadata.map_id, old_id);
  EXPECT_EQ(reply.map_id, metadata.map_id);
  EXPECT_EQ(metadata.trajectory[4].T_W_C.matrix(), right_.header(4).T_W_C.matrix());
  ExpectFollowed(&run);
  EXPECT_THAT(reply.message, HasSubstr("objects found again"));
  EXPECT_EQ(reply.encoding, "json");
  const auto links = nlohmann::json::parse(reply.payload);
  EXPECT_GE(links.at("became").size(), 2u);

  run.Send(Encode(Right(0, kRoomFrames)), 6);
  EXPECT_THAT(run.WaitForReply(6).message, HasSubstr("has these poses already"));
  run.Send(Message(3));
  EXPECT_EQ(run.status().counter("frames_duplicate"), 1);
  EXPECT_EQ(run.status().counter("frames_with_used_utime"), 0) << "its old pose is known";
}

TEST_F(CorrectedMap, ChangesFromTheFirstCorrectedFrameOn) {
  RunningServer run(config_);
  for (size_t i = 0; i < kRoomFrames; ++i) run.Send(Message(i));
  std::vector<Pose> poses = PosesOf(came_);
  for (const size_t i : {7u, 8u}) poses[i] = right_.header(i).T_W_C;
  PoseCorrection correction = Right(7, 9);
  correction.poses.push_back({424242, Pose::Identity()});
  run.Send(Encode(correction), 1);
  const map_reply_t reply = run.WaitForReply(1);
  EXPECT_TRUE(reply.ok) << reply.message;
  EXPECT_THAT(reply.message, HasSubstr("1 frame that the map does not have"));
  EXPECT_EQ(run.Hash(), HashOf(kRoomFrames, poses));
  // And once more, from before, with the checkpoints of the corrected map.
  poses[1] = right_.header(1).T_W_C;
  run.Send(Encode(Right(1, 2)), 2);
  EXPECT_TRUE(run.WaitForReply(2).ok);
  EXPECT_EQ(run.Hash(), HashOf(kRoomFrames, poses));
}

TEST_F(CorrectedMap, CarriesFramesBetweenKeyFrames) {
  RunningServer run(config_);
  for (size_t i = 0; i < kRoomFrames; ++i) run.Send(Message(i));
  PoseCorrection correction{came_.header(0).camera_id, true, {}};
  std::vector<PoseAtTime> frames;
  for (size_t i = 0; i < kRoomFrames; ++i) {
    frames.push_back({came_.header(i).utime, came_.header(i).T_W_C});
    if (i % 4 == 1) correction.poses.push_back({right_.header(i).utime, right_.header(i).T_W_C});
  }
  run.Send(Encode(correction), 1);
  const map_reply_t reply = run.WaitForReply(1);
  EXPECT_TRUE(reply.ok) << reply.message;
  EXPECT_THAT(reply.message, HasSubstr("3 frames named, 12 frames with another pose"));
  EXPECT_EQ(run.Hash(), HashOf(kRoomFrames, InterpolateCorrections(frames, correction.poses)));
}

TEST_F(CorrectedMap, GetsTheFramesThatCameMeanwhileWithTheirPoses) {
  RunningServer run(config_);
  for (size_t i = 0; i < 8; ++i) run.Send(Message(i));
  run.Send(Encode(Right(0, 8)), 1);
  for (size_t i = 8; i < kRoomFrames; ++i) run.Send(Message(i));
  EXPECT_TRUE(run.WaitForReply(1).ok);
  std::vector<Pose> poses = PosesOf(right_);
  for (size_t i = 8; i < kRoomFrames; ++i) poses[i] = came_.header(i).T_W_C;
  EXPECT_EQ(run.integrated, kRoomFrames);
  EXPECT_EQ(run.Hash(), HashOf(kRoomFrames, poses));
  ExpectFollowed(&run);
}

TEST_F(CorrectedMap, KeepsFramesThatWaitForTheOneBeforeThem) {
  RunningServer run(config_);
  for (size_t i = 0; i < 4; ++i) run.Send(Message(i));
  segmented_frame_t late = Message(5);
  late.frame.after_utime = came_.header(4).utime;
  run.Send(late);
  EXPECT_EQ(run.integrated, 4);
  run.Send(Encode(Right(0, 4)), 1);
  EXPECT_TRUE(run.WaitForReply(1).ok);
  run.Send(Message(4));
  EXPECT_EQ(run.integrated, 6);
}

TEST_F(CorrectedMap, HasThePosesOfBothOfTwoCorrections) {
  RunningServer run(config_);
  for (size_t i = 0; i < kRoomFrames; ++i) run.Send(Message(i));
  PoseCorrection moved = Right(0, 3);
  for (PoseAtTime& pose : moved.poses) pose.T_W_C.translation().x() += 0.2;
  run.Send(Encode(moved), 1);
  run.Send(Encode(Right(2, kRoomFrames)), 2);
  EXPECT_TRUE(run.WaitForReply(1).ok);
  EXPECT_TRUE(run.WaitForReply(2).ok);
  std::vector<Pose> poses = PosesOf(right_);
  for (const size_t i : {0u, 1u}) poses[i] = moved.poses[i].T_W_C;
  EXPECT_EQ(run.Hash(), HashOf(kRoomFrames, poses));
}

TEST_F(CorrectedMap, GoesOnToBeSavedAndIsRecoveredAfterACrash) {
  const auto expect_recovered = [&](const std::string& hash) {
    RunningServer again(config_);
    const Result<std::string> sentence = again.server().map().Recover();
    ASSERT_TRUE(sentence) << sentence.error().message;
    EXPECT_EQ(again.Hash(), hash) << *sentence;
  };
  {
    RunningServer run(config_);
    ASSERT_TRUE(run.server().map().Recover());
    for (size_t i = 0; i < 5; ++i) run.Send(Message(i));
    ASSERT_TRUE(run.server().map().Save());
    for (size_t i = 5; i < 9; ++i) run.Send(Message(i));
  }  // without saving at the end, as in a crash
  expect_recovered(HashOf(9, PosesOf(came_)));
  std::vector<Pose> poses = PosesOf(right_);
  {
    RunningServer run(config_);
    const Result<std::string> sentence = run.server().map().Recover();
    EXPECT_THAT(sentence.value_or(""),
                AllOf(HasSubstr("with 5 frames"), HasSubstr("journal of frames: 4 frames"),
                      HasSubstr("committed later: 0")));
    EXPECT_EQ(run.status().counter("frames_recovered_differently"), 0);
    run.Send(Encode(Right(0, 9)), 1);
    EXPECT_TRUE(run.WaitForReply(1).ok);
    run.Send(Message(9));
    poses[9] = came_.header(9).T_W_C;
    EXPECT_EQ(run.Hash(), HashOf(10, poses));
  }
  expect_recovered(HashOf(10, poses));  // the saved map has the poses of before
  {
    RunningServer run(config_);
    ASSERT_TRUE(run.server().map().Recover());
    ASSERT_TRUE(run.server().map().Save());
    run.Send(Message(10));
    poses[10] = came_.header(10).T_W_C;
  }
  expect_recovered(HashOf(11, poses));
}

// The child begins before this process has threads.
TEST(KilledServer, IsFollowedByOneWithTheCorrectedMapThatItHadNotMadeYet) {
  const TempFolder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  const CorrectedRoom room(folder.path());
  if (child == 0) {
    RunningServer run(room.config_);
    if (!run.server().map().Recover()) _exit(1);
    for (size_t i = 0; i < kRoomFrames; ++i) run.Send(room.Message(i));
    run.Send(Encode(room.Right(0, kRoomFrames)), 1);  // the answer comes when the map is made
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  RunningServer run(room.config_);
  const Result<std::string> sentence = run.server().map().Recover();
  ASSERT_TRUE(sentence) << sentence.error().message;
  EXPECT_THAT(*sentence, HasSubstr("journal of frames: 12 frames"));
  EXPECT_EQ(run.Hash(), room.HashOf(kRoomFrames, room.PosesOf(room.right_)));
}

/// A server in a process of its own, which makes a checkpoint before each frame, and says when a
/// frame is committed.
struct ChildServer {
  ChildServer() {
    EXPECT_EQ(pipe(pipe_), 0);
    pid_ = fork();
    if (pid_ == 0) Serve();
  }
  CorrectedRoom Room() const {
    CorrectedRoom room(folder_.path());
    room.config_.map_server.checkpoint_frames = 1;
    return room;
  }
  [[noreturn]] void Serve() const {
    const CorrectedRoom room = Room();
    RunningServer run(room.config_);
    if (!run.server().map().Recover()) _exit(1);
    for (size_t i = 0; i < kRoomFrames; ++i) {
      run.Send(room.Message(i));
      if (write(pipe_[1], "x", 1) != 1) _exit(1);
    }
    for (;;) pause();
  }
  /// Kills it as soon as so many frames are committed.
  void KillAfter(int frames) const {
    char byte = 0;
    for (int i = 0; i < frames; ++i) ASSERT_EQ(read(pipe_[0], &byte, 1), 1);
    kill(pid_, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(pid_, &status, 0), pid_);
    ASSERT_TRUE(WIFSIGNALED(status));
  }

  TempFolder folder_;
  int pipe_[2];
  pid_t pid_ = -1;
};

// The frames under way then, and those that the disk has not, are not in the map, and no other ones
// are lost.
TEST(KilledServer, IsFollowedByOneWithTheFramesThatTheDiskHas) {
  const std::array<ChildServer, 3> children;
  int after = 3;
  for (const ChildServer& child : children) {
    child.KillAfter(after);
    const CorrectedRoom room = child.Room();
    RunningServer run(room.config_);
    const Result<std::string> sentence = run.server().map().Recover();
    ASSERT_TRUE(sentence) << sentence.error().message;
    const auto frames = static_cast<size_t>(run.server().map().session().map().revision);
    EXPECT_GE(frames, static_cast<size_t>(after) - 2) << *sentence;
    EXPECT_EQ(run.Hash(), room.HashOf(frames, room.PosesOf(room.came_)));
    run.Send(Encode(room.Right(0, frames)), 1);
    EXPECT_TRUE(run.WaitForReply(1).ok);
    EXPECT_EQ(run.Hash(), room.HashOf(frames, room.PosesOf(room.right_)));
    after += 4;
  }
}

TEST_F(CorrectedMap, IsRefusedWithTheReasonWhenTheDiskWasFull) {
  RunningServer run(config_);
  for (size_t i = 0; i < 3; ++i) run.Send(Message(i));
  FrameJournal& journal = *run.server().map().history().journal();
  ASSERT_TRUE(journal.AddPoses({}));  // all are written
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit full{journal.bytes() + 100, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  run.Send(Message(3));
  EXPECT_FALSE(journal.Read(4));
  run.Send(Encode(Right(0, 3)), 1);
  const map_reply_t refused = run.WaitForReply(1);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  EXPECT_FALSE(refused.ok);
  EXPECT_THAT(refused.message,
              AllOf(HasSubstr("lacks frame 4"), HasSubstr("incomplete from frame 4"),
                    HasSubstr("File too large")));
  for (size_t i = 4; i < 8; ++i) run.Send(Message(i));
  EXPECT_EQ(run.integrated, 8) << "the map goes on";
  EXPECT_EQ(run.Hash(), HashOf(8, PosesOf(came_)));
  run.Send(Encode(Right(7, 8)), 2);
  const map_reply_t later = run.WaitForReply(2);
  EXPECT_TRUE(later.ok) << later.message << " (a checkpoint is behind the gap)";
}

TEST_F(CorrectedMap, IsNotMixedWithTheFramesOfAnotherOne) {
  {
    RunningServer run(config_);
    ASSERT_TRUE(run.server().map().Recover());
    for (size_t i = 0; i < 4; ++i) run.Send(Message(i));
    ASSERT_TRUE(run.server().map().Save());
    run.server().map().Reset();
    for (size_t i = 6; i < 9; ++i) run.Send(Message(i));
  }
  RunningServer run(config_);
  const Result<std::string> sentence = run.server().map().Recover();
  ASSERT_TRUE(sentence);
  EXPECT_THAT(*sentence, HasSubstr("the saved map is not the one"));
  MapSession expected(config_, {});
  for (size_t i = 6; i < 9; ++i)
    MapFrame(*DecodeFrame(came_.sensor[i]), &came_.detections[i], config_, &expected);
  EXPECT_EQ(run.Hash(), HashMap(expected.map()));
}

TEST_F(CorrectedMap, IsGivenUpWhenAnotherMapComes) {
  RunningServer run(config_);
  for (size_t i = 0; i < kRoomFrames; ++i) run.Send(Message(i));
  run.Send(Encode(Right(0, kRoomFrames)), 1);
  if (run.replies.empty()) {
    run.server().map().Reset();
    const map_reply_t reply = run.WaitForReply(1);
    EXPECT_FALSE(reply.ok);
    EXPECT_THAT(reply.message, HasSubstr("another map"));
    EXPECT_EQ(run.server().map().session().map().revision, 0);
  }
  run.server().map().Reset();
  run.Send(Message(2));
  run.Send(Encode(Right(2, 3)), 2);
  EXPECT_TRUE(run.WaitForReply(2).ok);
}

TEST_F(CorrectedMap, IsMadeAgainOnlyForCorrectionsThatAreRightAndAllowed) {
  RunningServer run(config_);
  for (size_t i = 0; i < 4; ++i) run.Send(Message(i));
  const std::string hash = run.Hash();
  int64_t id = 0;
  const auto refusal = [&](const pose_correction_t& correction) {
    run.Send(correction, ++id);
    const map_reply_t reply = run.WaitForReply(id);
    EXPECT_FALSE(reply.ok);
    return reply.message;
  };
  PoseCorrection correction = Right(0, 4);
  correction.camera_id = CameraId{99};
  EXPECT_THAT(refusal(Encode(correction)), HasSubstr("has none of the 4 frames of camera 99"));
  pose_correction_t spoilt = Encode(Right(0, 4));
  spoilt.poses[2].T_W_C[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(spoilt), HasSubstr("NaN"));
  EXPECT_EQ(run.Hash(), hash);
  EXPECT_EQ(run.status().counter("corrections_refused"), 2);

  config_.map_server.accept_corrections = false;
  RunningServer closed(config_);
  closed.Send(Encode(Right(0, 4)), 1);
  EXPECT_THAT(closed.WaitForReply(1).message, HasSubstr("takes no corrections of poses"));
}

TEST_F(CorrectedMap, NeedsTheFramesFromTheFirstChangedOneOn) {
  config_.map_server.frame_journal_mb = 1;
  RunningServer run(config_);
  // So many frames that the first ones are dropped.
  FrameJournal& journal = *run.server().map().history().journal();
  size_t sent = 0;
  for (; sent < kRoomFrames; ++sent) run.Send(Message(sent));
  ASSERT_TRUE(journal.AddPoses({}));
  for (int64_t utime = 1; utime < 400 && journal.Frames().front().revision == 1; ++utime) {
    segmented_frame_t more = Message(static_cast<size_t>(utime) % kRoomFrames);
    more.frame.utime = more.utime = 900'000'000 + utime;
    run.Send(more);
    ASSERT_TRUE(journal.AddPoses({}));
  }
  ASSERT_GT(journal.Frames().front().revision, 1);
  const std::string hash = run.Hash();
  run.Send(Encode(Right(0, 1)), 1);
  const map_reply_t reply = run.WaitForReply(1);
  EXPECT_FALSE(reply.ok);
  EXPECT_THAT(reply.message, HasSubstr("is not in the journal of frames"));
  EXPECT_EQ(run.Hash(), hash);
}

}  // namespace
}  // namespace vismap
