#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <map>
#include <vismap/detections_t.hpp>

#include "process/room_pipeline.h"
#include "simulation/sequence.h"
#include "support/tiny_onnx.h"
#include "wire/detections.h"
#include "wire/frame_key.h"
#include "wire/rgbd_frame.h"

// The detector with a network that finds red objects: the couch of the built-in room.

namespace vismap {
namespace {

/// The network and its config in a folder.
class TinyDetector {
 public:
  TinyDetector() {
    folder_.Write("tiny.onnx", TinyYolo().Model());
    folder_.Write("names.txt", TinyYolo::ClassNames());
    folder_.Write("config.txtpb", "detector { model: \"" + (folder_ / "tiny.onnx").string() +
                                      "\" class_names: \"" + (folder_ / "names.txt").string() +
                                      "\" threads: 1 }\n");
  }
  std::vector<std::string> Arguments(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--config", (folder_ / "config.txtpb").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

 private:
  TempFolder folder_;
};

/// All DETECTIONS messages, by frame.
class Answers {
 public:
  explicit Answers(ProcessBus* processes) {
    processes->bus().Subscribe<detections_t>(kDetectionsChannel,
                                             [this](const detections_t& message) {
                                               ++count_[KeyOf(message)];
                                               looked_[KeyOf(message)] = DetectorRan(message);
                                               found_ += message.n_detections;
                                             });
  }
  size_t frames() const { return count_.size(); }
  int found() const { return found_; }
  bool DetectorRanOn(const FrameKey& key) const { return looked_.contains(key) && looked_.at(key); }
  int looked_at() const {
    return static_cast<int>(std::count_if(looked_.begin(), looked_.end(),
                                          [](const auto& entry) { return entry.second; }));
  }
  bool EachOnce() const {
    return std::all_of(count_.begin(), count_.end(),
                       [](const auto& entry) { return entry.second == 1; });
  }

 private:
  std::map<FrameKey, int> count_;
  std::map<FrameKey, bool> looked_;
  int found_ = 0;
};

TEST(DnnDetector, EveryFrameModeGivesTheMapOfTheOfflineMapper) {
  const TinyDetector tiny;
  ProcessBus processes;
  Answers answers(&processes);
  RoomPipeline pipeline(&processes);
  pipeline.resend = 30;
  pipeline.detector_arguments = tiny.Arguments({"--every-frame"});
  pipeline.Start();
  pipeline.WaitForEnd();
  EXPECT_EQ(pipeline.integrated(), RoomPipeline::kFrames);
  EXPECT_EQ(answers.looked_at(), RoomPipeline::kFrames);
  EXPECT_TRUE(answers.EachOnce());
  EXPECT_GE(answers.found(), 1) << "the couch";
  EXPECT_EQ(ServerStatistic(&processes, "hash"),
            OfflineRoomHash("2", RoomPipeline::kRoom, tiny.Arguments()));
}

TEST(DnnDetector, NewestFrameModeIntegratesEveryFrameWithoutWaiting) {
  const TinyDetector tiny;
  ProcessBus processes;
  Answers answers(&processes);
  RoomPipeline pipeline(&processes);
  pipeline.resend = 30;
  pipeline.detector_arguments = tiny.Arguments({"--backend", "dnn"});
  pipeline.Start();
  pipeline.WaitForEnd();
  EXPECT_EQ(pipeline.integrated(), RoomPipeline::kFrames);
  EXPECT_EQ(answers.frames(), static_cast<size_t>(RoomPipeline::kFrames));
  EXPECT_TRUE(answers.EachOnce());
  EXPECT_GE(answers.looked_at(), 1);
}

TEST(DnnDetector, RunsOnTheNewestFrameOfABacklogAndSkipsTheOthers) {
  constexpr int kBacklog = 40;
  const TinyDetector tiny;
  ProcessBus processes;
  Answers answers(&processes);
  auto detector = processes.Start("detector", tiny.Arguments());
  ASSERT_TRUE(processes.WaitForReady({"detector"}));
  const auto room = OpenSequence("synthetic:room?frames=1&width=64", "");
  ASSERT_TRUE(room) << room.error().message;
  rgbd_frame_t frame = Encode(*(*room)->Read(0));
  detector->Signal(SIGSTOP);
  for (int i = 0; i < kBacklog; ++i) {
    frame.utime = i;
    processes.bus().Publish(kRgbdFrameChannel, frame);
  }
  detector->Signal(SIGCONT);
  EXPECT_TRUE(processes.SpinUntil([&] { return answers.frames() == kBacklog; }))
      << "only " << answers.frames();
  EXPECT_TRUE(answers.EachOnce());
  EXPECT_TRUE(answers.DetectorRanOn({CameraId{frame.camera_id}, kBacklog - 1})) << "the newest";
  EXPECT_LT(answers.looked_at(), kBacklog / 2);
  detector->Signal(SIGTERM);
  EXPECT_EQ(detector->WaitForExit(), 0);
  EXPECT_THAT(detector->StandardError(), ::testing::HasSubstr("; skipped "));
}

TEST(DnnDetector, RepeatedFrameGetsTheSameDetections) {
  const TinyDetector tiny;
  ProcessBus processes;
  std::vector<detections_t> answers;
  processes.bus().Subscribe<detections_t>(
      kDetectionsChannel, [&](const detections_t& message) { answers.push_back(message); });
  auto detector = processes.Start("detector", tiny.Arguments());
  ASSERT_TRUE(processes.WaitForReady({"detector"}));
  const auto room = OpenSequence("synthetic:room?frames=1&width=64", "");
  ASSERT_TRUE(room) << room.error().message;
  for (size_t times = 1; times <= 2; ++times) {
    processes.bus().Publish(kRgbdFrameChannel, Encode(*(*room)->Read(0)));
    ASSERT_TRUE(processes.SpinUntil([&] { return answers.size() == times; }));
  }
  EXPECT_TRUE(DetectorRan(answers[0]));
  EXPECT_TRUE(DetectorRan(answers[1]));
  EXPECT_EQ(answers[0].n_detections, answers[1].n_detections);
}

TEST(DnnDetector, WrittenFileGivesTheSameMap) {
  const TinyDetector tiny;
  const TempFolder folder;
  const std::string file = (folder / "detections.json").string();
  ChildProcess writer(
      "detector",
      tiny.Arguments({"--backend", "dnn", "--dataset", RoomPipeline::kRoom, "--out", file}),
      folder.path());
  EXPECT_EQ(writer.WaitForExit(), 0) << writer.StandardError();
  EXPECT_EQ(OfflineRoomHash("2", RoomPipeline::kRoom, {"--detections", file}),
            OfflineRoomHash("2", RoomPipeline::kRoom, tiny.Arguments()));
}

TEST(DnnDetector, FramesWithoutColourAreSkipped) {
  const TinyDetector tiny;
  ProcessBus processes;
  Answers answers(&processes);
  auto detector = processes.Start("detector", tiny.Arguments());
  ASSERT_TRUE(processes.WaitForReady({"detector"}));
  const auto room = OpenSequence("synthetic:room?frames=1&width=64", "");
  ASSERT_TRUE(room) << room.error().message;
  SensorFrame frame = *(*room)->Read(0);
  frame.color.clear();
  processes.bus().Publish(kRgbdFrameChannel, Encode(frame));
  EXPECT_TRUE(processes.SpinUntil([&] { return answers.frames() == 1; }));
  EXPECT_EQ(answers.looked_at(), 0);
}

}  // namespace
}  // namespace vismap
