#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "doctor/findings.h"
#include "doctor/report.h"
#include "runtime/version.h"
#include "support/messages.h"
#include "wire/channel_types.h"
#include "wire/channels.h"
#include "wire/envelope.h"
#include "wire/fingerprint.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int64_t kUtime = 1'700'000'000'000'000;

/// A bus that is observed for five seconds, from time 0 on.
struct Scene {
  BusPicture picture;
  Listening listening{{{"hub", true, "answers"}}, 5, 5, "tcpq://127.0.0.1:7700"};

  process_status_t Status(const std::string& process, const std::string& state = "running") {
    process_status_t status{};
    status.source = status.process = process;
    status.host = "robot";
    status.pid = 42;
    status.state = state;
    status.version = Version();
    status.types_fingerprint = TypesFingerprint();
    status.start_utime = 1;
    return status;
  }
  /// Receives this status once a second.
  void PublishesStatus(process_status_t status) {
    for (int second = 0; second < 5; ++second) {
      status.utime =
          status.utime == 0 || second > 0 ? kUtime + second * 1'000'000 + offset : status.utime;
      status.seq = second;
      Receives("STATUS", Pack(status), second);
    }
  }
  template <typename Message>
  void PublishesChannel(const Channel& channel, Message message) {
    for (int i = 0; i < 50; ++i) {
      message.seq = i;
      message.source = "publisher";
      Receives(channel.name, Pack(message), i / 10);
    }
  }
  void Receives(const std::string& channel, const std::vector<uint8_t>& bytes, int second) {
    picture.AddMessage(channel, bytes, second, kUtime + second * 1'000'000);
  }
  void FullPipeline() {
    for (const char* name : {"hub", "map-server", "depth-segmenter", "detector"}) {
      PublishesStatus(Status(name));
    }
    for (const Channel& channel : {kSegmentedFrameChannel, kMapCommitChannel}) {
      std::vector<uint8_t> bytes = Pack(frame_);
      envelope::WriteBigEndian(FindChannelType(channel.name)->fingerprint, bytes.data());
      Receives(channel.name, bytes, 4);
    }
    PublishesChannel(kRgbdFrameChannel, rgbd_frame_t{});
    PublishesChannel(kDetectionsChannel, detections_t{});
  }
  /// "what; todo" of all findings.
  std::vector<std::string> Findings() {
    std::vector<std::string> texts;
    for (const Finding& finding : Diagnose(listening, picture)) {
      texts.push_back(finding.what + "; " + finding.todo);
    }
    return texts;
  }

  int64_t offset = 0;

 private:
  rgbd_frame_t frame_{};
};

TEST(Doctor, HealthyBusHasNoFindings) {
  Scene scene;
  scene.FullPipeline();
  EXPECT_THAT(scene.Findings(), IsEmpty());
}

TEST(Doctor, MissingHubIsTheOnlyFindingAndNamesTheCommand) {
  Scene scene;
  scene.listening.checks = {{"hub", false, "none; start one with: vismap-hub"}};
  EXPECT_THAT(scene.Findings(), ElementsAre(HasSubstr("start one with: vismap-hub")));
}

TEST(Doctor, EmptyBusIsAFinding) {
  Scene scene;
  EXPECT_THAT(scene.Findings(), ElementsAre(AllOf(HasSubstr("no process is on the bus"),
                                                  HasSubstr("127.0.0.1:7700"))));
}

TEST(Doctor, MissingDetectorIsAFinding) {
  Scene scene;
  scene.PublishesStatus(scene.Status("map-server", "ready"));
  process_status_t segmenter = scene.Status("depth-segmenter", "waiting");
  segmenter.message = "waiting for DETECTIONS: the oldest frame has waited for 5 s";
  scene.PublishesStatus(segmenter);
  scene.PublishesChannel(kRgbdFrameChannel, rgbd_frame_t{});
  EXPECT_THAT(scene.Findings(),
              ElementsAre("depth-segmenter waits for DETECTIONS, but no DETECTIONS was received in "
                          "5 s; start vismap-detector, "
                          "or run vismap-depth-segmenter with --detections none"));
}

TEST(Doctor, MissingSensorSegmenterAndServerAreFindings) {
  Scene no_sensor;
  no_sensor.PublishesStatus(no_sensor.Status("map-server", "ready"));
  EXPECT_THAT(no_sensor.Findings(), ElementsAre(HasSubstr("start vismap-sensor-replay")));
  Scene no_segmenter;
  no_segmenter.PublishesStatus(no_segmenter.Status("map-server", "ready"));
  no_segmenter.PublishesChannel(kRgbdFrameChannel, rgbd_frame_t{});
  EXPECT_THAT(no_segmenter.Findings(), ElementsAre(HasSubstr("start vismap-depth-segmenter")));
  Scene no_server;
  no_server.PublishesStatus(no_server.Status("depth-segmenter", "ready"));
  EXPECT_THAT(no_server.Findings(), Contains(HasSubstr("start vismap-map-server")));
}

TEST(Doctor, OtherTypesAndVersionsAreFindings) {
  Scene scene;
  scene.FullPipeline();
  process_status_t other = scene.Status("octomap-exporter");
  other.types_fingerprint = 7;
  other.version = "9.9.9";
  scene.PublishesStatus(other);
  EXPECT_THAT(scene.Findings(),
              ElementsAre(AllOf(HasSubstr("octomap-exporter on robot uses other message types"),
                                HasSubstr("9.9.9"), HasSubstr("same version"))));
  scene.PublishesChannel(kMapDeltaChannel, detections_t{});
  EXPECT_THAT(scene.Findings(),
              Contains(HasSubstr("MAP_DELTA: 50 of 50 messages have a wrong type")));
}

TEST(Doctor, NamesThePrefixThatOtherProcessesUse) {
  Scene scene;
  process_status_t status = scene.Status("map-server");
  scene.Receives("vismap/STATUS", Pack(status), 1);
  scene.Receives("vismap/OCTOMAP", {1, 2, 3}, 1);  // no message of ours
  EXPECT_THAT(scene.Findings(), Contains(AllOf(HasSubstr("channel vismap/STATUS carries"),
                                               HasSubstr("process_status_t"), HasSubstr("''"),
                                               HasSubstr("--channel-prefix 'vismap/'"))));
  EXPECT_FALSE(scene.picture.Has("map-server"));
}

TEST(Doctor, AnotherPipelineBesideACompleteOneIsNoFinding) {
  Scene scene;
  scene.FullPipeline();
  process_status_t other = scene.Status("map-server", "waiting");
  other.source = "other";
  other.message = "no frame";
  scene.Receives("B_STATUS", Pack(other), 4);
  EXPECT_THAT(scene.Findings(), IsEmpty());
  EXPECT_THAT(TextReport(scene.listening, scene.picture, {}), HasSubstr("with the prefix 'B_'"));
}

TEST(Doctor, WithAPrefixItKnowsTheChannelsThatHaveIt) {
  BusPicture picture("vismap/");
  Scene scene;
  const auto receive = [&](const std::string& channel, const std::string& process) {
    process_status_t status = scene.Status(process);
    picture.AddMessage(channel, Pack(status), 1, kUtime);
  };
  receive("vismap/STATUS", "map-server");
  receive("STATUS", "depth-segmenter");
  receive("STATUS", "hub");  // serves all of them
  EXPECT_TRUE(picture.Has("map-server"));
  EXPECT_TRUE(picture.Has("hub"));
  EXPECT_FALSE(picture.Has("depth-segmenter"));
  EXPECT_EQ(picture.messages("STATUS"), 1);
}

TEST(Doctor, ClockDifferencesAreFindings) {
  Scene scene;
  scene.FullPipeline();
  scene.offset = -3'000'000;
  scene.PublishesStatus(scene.Status("octomap-exporter"));
  EXPECT_THAT(scene.Findings(),
              ElementsAre(AllOf(HasSubstr("clock of robot is 3 s behind"), HasSubstr("chrony"))));
}

TEST(Doctor, OnlyRecentLossesAreFindings) {
  Scene scene;
  scene.FullPipeline();
  process_status_t bridge = scene.Status("bridge");
  bridge.counter_names = {"send.RGBD_FRAME.dropped", "remote.reconnects"};
  bridge.counter_values = {100, 1};
  bridge.n_counters = 2;
  scene.PublishesStatus(bridge);
  EXPECT_THAT(scene.Findings(), IsEmpty());
  bridge.counter_values = {107, 1};
  bridge.seq = 5;
  bridge.utime = kUtime + 4'000'000;
  scene.Receives("STATUS", Pack(bridge), 4);
  EXPECT_THAT(scene.Findings(),
              ElementsAre(AllOf(HasSubstr("bridge on robot dropped 7 messages"),
                                HasSubstr("send.RGBD_FRAME.dropped, 107 in total"))));
}

TEST(Doctor, WhatAProcessFindsSuspectIsAFinding) {
  Scene scene;
  scene.FullPipeline();
  process_status_t server = scene.Status("map-server");
  server.findings = {"the frames contradict each other", "3 of 10 frames were left out"};
  server.n_findings = 2;
  server.seq = 5;  // after those of the full pipeline
  server.utime = kUtime + 4'000'000;
  scene.Receives("STATUS", Pack(server), 4);
  EXPECT_THAT(scene.Findings(),
              ElementsAre("map-server on robot: the frames contradict each other; ",
                          "map-server on robot: 3 of 10 frames were left out; "));
  const auto json = nlohmann::json::parse(
      JsonReport(scene.listening, scene.picture, Diagnose(scene.listening, scene.picture)));
  EXPECT_FALSE(json["healthy"].get<bool>());
}

TEST(Doctor, WhatAProcessWaitsForIsToldOnceWhenItIsAFindingToo) {
  Scene scene;
  scene.FullPipeline();
  process_status_t adapter = scene.Status("adapter");
  adapter.state = "waiting";
  adapter.message = "no message came on /tf";
  adapter.findings = {"no message came on /tf", "no message came on /depth"};
  adapter.n_findings = 2;
  adapter.utime = kUtime + 4'000'000;
  scene.Receives("STATUS", Pack(adapter), 4);
  EXPECT_THAT(scene.Findings(), ElementsAre("adapter on robot: no message came on /tf; ",
                                            "adapter on robot: no message came on /depth; "));
}

TEST(Doctor, ReportsOnHowManyFramesADetectorRan) {
  Scene scene;
  scene.FullPipeline();
  process_status_t segmenter = scene.Status("depth-segmenter");
  segmenter.source = "slow";
  segmenter.counter_names = {"frames", "frames_with_detections"};
  segmenter.n_counters = 2;
  for (int second = 0; second < 5; ++second) {
    segmenter.counter_values = {1000 + 150 / 4 * second, 40 + 5 / 4 * second};
    segmenter.utime = kUtime + second * 1'000'000;
    segmenter.seq = second;
    scene.Receives("STATUS", Pack(segmenter), second);
  }
  EXPECT_THAT(TextReport(scene.listening, scene.picture, {}),
              HasSubstr("slow: 29.6 frames per second; a detector ran on 0.8 of them; the others "
                        "are mapped without detections"));
  const auto json = nlohmann::json::parse(JsonReport(scene.listening, scene.picture, {}));
  EXPECT_NEAR(json["detection_rates"][0]["with_detector_per_s"].get<double>(), 0.8, 1e-9);
  EXPECT_THAT(scene.Findings(), IsEmpty()) << "a slow detector is not a problem";
}

TEST(Doctor, LostMessagesSilenceAndDuplicateNamesAreFindings) {
  Scene scene;
  scene.FullPipeline();
  rgbd_frame_t late{};
  late.source = "publisher";
  late.seq = 60;
  scene.Receives("RGBD_FRAME", Pack(late), 4);
  EXPECT_THAT(scene.Findings(),
              ElementsAre(HasSubstr("RGBD_FRAME: 10 messages of the sequence were not received")));
  Scene two;
  two.FullPipeline();
  process_status_t twin = two.Status("detector");
  for (const int64_t start : {50, 1, 50}) {
    twin.start_utime = start;
    twin.pid = static_cast<int32_t>(start);
    twin.utime = kUtime + 4'000'000;
    twin.seq = start;
    two.Receives("STATUS", Pack(twin), 4);
  }
  EXPECT_THAT(two.Findings(), Contains(AllOf(HasSubstr("two processes have the name detector"),
                                             HasSubstr("--name"))));
  Scene silent;
  silent.FullPipeline();
  silent.listening.now = 9;
  EXPECT_THAT(silent.Findings(),
              Contains(HasSubstr("map-server on robot has published no STATUS for 5 s")));
}

TEST(Doctor, StrangerWithTheNameOfTheServerDoesNotHideIt) {
  Scene scene;
  scene.FullPipeline();
  process_status_t server = scene.Status("map-server", "waiting");
  server.message = "the disk is full";
  process_status_t stranger = server;
  stranger.pid = 666;
  stranger.message = "all is well";
  for (int second = 0; second < 5; ++second) {
    server.seq = stranger.seq = 5 + second;
    scene.Receives("STATUS", Pack(stranger), second);
    scene.Receives("STATUS", Pack(server), second);
  }
  EXPECT_THAT(scene.Findings(), Contains(HasSubstr("the disk is full")));
  EXPECT_THAT(scene.Findings(), Contains(AllOf(HasSubstr("two processes have the name map-server"),
                                               HasSubstr("pid 666"), HasSubstr("pid 42"))));
}

TEST(Doctor, ReportContainsNoControlCharactersFromTheBus) {
  Scene scene;
  process_status_t hostile = scene.Status("x\033[2Jy");
  hostile.message = "\r\xff\n";
  scene.PublishesStatus(hostile);
  const auto findings = Diagnose(scene.listening, scene.picture);
  EXPECT_EQ(TextReport(scene.listening, scene.picture, findings).find('\033'), std::string::npos);
  const auto json =
      nlohmann::json::parse(JsonReport(scene.listening, scene.picture, findings), nullptr, false);
  EXPECT_TRUE(json.is_object());
  EXPECT_FALSE(json["healthy"].get<bool>());
}

TEST(Doctor, TellsHowFarTheMapIsBehindTheCamera) {
  Scene scene;
  scene.FullPipeline();
  rgbd_frame_t frame = Encode(SmallSensorFrame(0, 3));
  frame_commit_t commit{};
  commit.camera_id = 3;
  for (int second = 0; second < 5; ++second) {
    frame.utime = kUtime + second * 1'000'000;
    scene.Receives(kRgbdFrameChannel.name, Pack(frame), second);
    commit.utime = kUtime - 60'000'000 + second * 200'000;
    scene.Receives(kMapCommitChannel.name, Pack(commit), second);
  }
  EXPECT_THAT(scene.Findings(),
              Contains(AllOf(HasSubstr("the map is 63.2 s behind camera 3"),
                             HasSubstr("further behind in 5 s"), HasSubstr("overload: NEWEST"))));
  EXPECT_THAT(TextReport(scene.listening, scene.picture, {}),
              HasSubstr("The map is 63.2 s behind camera 3"));
}

TEST(Doctor, AGapBetweenTwoFramesIsNoLag) {
  Scene scene;
  scene.FullPipeline();
  rgbd_frame_t frame = Encode(SmallSensorFrame(0, 3));
  frame_commit_t commit{};
  commit.camera_id = 3;
  for (int second = 0; second < 5; ++second) {
    frame.utime = commit.utime = kUtime + second * 10'000'000;
    scene.Receives(kRgbdFrameChannel.name, Pack(frame), second);
    scene.Receives(kMapCommitChannel.name, Pack(commit), second);
  }
  EXPECT_THAT(scene.Findings(), Not(Contains(HasSubstr("behind camera"))));
}

}  // namespace
}  // namespace vismap
