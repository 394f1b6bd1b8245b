#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vismap/frame_commit_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "codecs/color_codec.h"
#include "logs/log_writer.h"
#include "logs/recording.h"
#include "process/room_pipeline.h"
#include "runtime/clock.h"
#include "support/foreign_builder.h"

// vismap-adapter and logs of other robots' programs: the same messages give the same map, live and
// offline.

namespace vismap {
namespace {

using namespace foreign_test;  // NOLINT
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr char kAdapterRoom[] = "synthetic:room?frames=10&width=160";

/// A message of a robot.
struct RobotMessage {
  int64_t time = 0;  // [us]
  std::string channel;
  Bytes bytes;
};

Bytes RawImage(const FrameHeader& header, const std::string& encoding, Bytes data) {
  foreign::sensor_msgs::Image image{};
  image.header = RosHeader(header.utime, "optical");
  image.width = header.camera.width;
  image.height = header.camera.height;
  image.encoding = encoding;
  image.step = static_cast<int32_t>(data.size()) / image.height;
  image.data = std::move(data);
  image.data_length = static_cast<int32_t>(image.data.size());
  return Pack(image);
}

template <typename T>
Bytes BytesOf(const Image<T>& image) {
  Bytes bytes(image.size() * sizeof(T));
  std::memcpy(bytes.data(), image.data(), bytes.size());
  return bytes;
}

Bytes InfoOf(const FrameHeader& header) {
  foreign::sensor_msgs::CameraInfo info{};
  info.header = RosHeader(header.utime, "optical");
  info.width = header.camera.width;
  info.height = header.camera.height;
  info.K[0] = header.camera.fx;
  info.K[4] = header.camera.fy;
  info.K[2] = header.camera.cx;
  info.K[5] = header.camera.cy;
  return Pack(info);
}

/// The built-in room as a DimOS robot sends it: the pose before and after each image.
std::vector<RobotMessage> RoomOfDimos() {
  const Result<Recording> room = OpenRecording(kAdapterRoom, "");
  std::vector<RobotMessage> messages;
  for (size_t i = 0; i < (*room).dataset->size(); ++i) {
    const Result<SensorFrame> frame = room->dataset->Read(i);
    const FrameHeader& header = frame->header;
    const auto pose = [&](int64_t utime) {
      messages.push_back(
          {utime, kTfChannel, Tf({Transform(utime, "world", "optical", header.T_W_C)})});
    };
    if (i == 0) messages.push_back({header.utime - 9000, kInfoChannel, InfoOf(header)});
    pose(header.utime - 8000);
    const Result<Image<Rgb8>> color = DecodeJpeg(frame->color);
    messages.push_back({header.utime, kColorChannel, RawImage(header, "rgb8", BytesOf(*color))});
    messages.push_back(
        {header.utime + 1, kDepthChannel, RawImage(header, "16UC1", BytesOf(frame->depth))});
    pose(header.utime + 7000);
  }
  return messages;
}

std::string WriteLogOf(const std::vector<RobotMessage>& messages,
                       const std::filesystem::path& path) {
  LogWriter writer = *LogWriter::Create(path);
  for (const RobotMessage& message : messages)
    writer.Add(message.time, message.channel, message.bytes);
  EXPECT_TRUE(writer.Finish());
  return path.string();
}

std::string OfflineHash(const std::string& log, const std::filesystem::path& folder) {
  ChildProcess mapper(
      "offline-mapper",
      {"--dataset", log, "--detections", "none", "--out", (folder / "out").string()}, folder);
  EXPECT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
  const std::string text = mapper.StandardOutput();
  const size_t at = text.find("map hash ");
  return at == std::string::npos ? "" : text.substr(at + 9, 32);
}

Result<std::unique_ptr<Transport>> Connect(const std::string& url) {
  const Result<LcmUrl> parsed = ParseLcmUrl(url);
  return parsed->provider == "tcpq" ? OpenTcpqTransport(parsed->hub, nullptr)
                                    : OpenLcmTransport(*parsed);
}

/// Sends messages on the bus as lcm-logplayer does: byte for byte.
void Play(const std::vector<RobotMessage>& messages, const std::string& url) {
  const auto transport = Connect(url);
  ASSERT_TRUE(transport) << transport.error().message;
  for (const RobotMessage& message : messages) {
    EXPECT_TRUE((*transport)->Publish(message.channel, message.bytes));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// A bus of multicast that no other test uses.
std::string MulticastUrl(int receive_buffer) {
  return "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) +
         "?ttl=0&recv_buf_size=" + std::to_string(receive_buffer);
}

TEST(Adapter, MapsARobotLiveAsItsLogOffline) {
  const std::vector<RobotMessage> messages = RoomOfDimos();
  ProcessBus processes;
  const std::string log = WriteLogOf(messages, processes.folder() / "robot.lcmlog");
  const std::string offline = OfflineHash(log, processes.folder());
  ASSERT_EQ(offline.size(), 32u);

  const std::string converted = (processes.folder() / "ours.lcmlog").string();
  ChildProcess convert("log", {"convert", log, "--out", converted}, processes.folder());
  EXPECT_EQ(convert.WaitForExit(), 0) << convert.StandardError();
  EXPECT_EQ(OfflineHash(converted, processes.folder()), offline);

  int integrated = 0;
  processes.bus().Subscribe<frame_commit_t>(kMapCommitChannel, [&](const frame_commit_t& commit) {
    if (commit.status == frame_commit_t::STATUS_INTEGRATED) ++integrated;
  });
  const auto server = processes.Start("map-server");
  const auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  // As DimOS starts it.
  const auto adapter =
      processes.Start("adapter", {"--color_image", kColorChannel, "--depth_image", kDepthChannel,
                                  "--camera_info", kInfoChannel, "--preset", "dimos",
                                  "--swap_red_blue", "false", "--log-format", "json"});
  ASSERT_TRUE(processes.WaitForReady({"map-server", "depth-segmenter", "adapter"}));
  Play(messages, processes.url());
  EXPECT_TRUE(processes.SpinUntil([&] { return integrated == 10; }));
  EXPECT_EQ(ServerStatistic(&processes, "hash"), offline);

  const double start = MonotonicSeconds();
  adapter->Signal(SIGTERM);
  EXPECT_EQ(adapter->WaitForExit(), 0);
  EXPECT_LT(MonotonicSeconds() - start, 2) << "DimOS kills it then";
  std::istringstream lines(adapter->StandardError());
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(json.is_object()) << line;
    EXPECT_TRUE(json.contains("level") && json.contains("message")) << line;
  }
}

TEST(Adapter, SaysInItsStatusWhatIsDroppedAndWhatToDo) {
  std::vector<RobotMessage> messages = RoomOfDimos();
  std::erase_if(messages,
                [](const RobotMessage& message) { return message.channel == kTfChannel; });
  ProcessBus processes;
  std::vector<std::string> findings;
  processes.bus().Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process == "adapter") findings = status.findings;
  });
  const auto adapter = processes.Start("adapter", {"--preset", "dimos"});
  ASSERT_TRUE(processes.WaitForReady({"adapter"}));
  Play(messages, processes.url());
  EXPECT_TRUE(processes.SpinUntil([&] { return findings.size() == 2; }));
  EXPECT_THAT(findings, Contains(HasSubstr("no poses connect the frame 'optical' with 'world'")));
  EXPECT_THAT(findings, Contains(HasSubstr("no message came on /tf#tf2_msgs.TFMessage")));
}

TEST(Adapter, SaysWhichPoseItIgnoresAndWhy) {
  std::vector<RobotMessage> messages = RoomOfDimos();
  foreign::geometry_msgs::TransformStamped bad = Transform(5, "optical", "arm", Pose::Identity());
  bad.transform.rotation.w = 0;
  messages.insert(messages.begin() + 4,
                  {messages[4].time, kTfChannel,
                   Tf({bad, Transform(messages[4].time, "optical", "hand", Pose::Identity())})});
  ProcessBus processes;
  std::vector<std::string> findings;
  int64_t frames = 0;
  processes.bus().Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process != "adapter") return;
    findings = status.findings;
    for (size_t i = 0; i < status.counter_names.size(); ++i) {
      if (status.counter_names[i] == "frames") frames = status.counter_values[i];
    }
  });
  const auto adapter = processes.Start("adapter", {"--preset", "dimos"});
  ASSERT_TRUE(processes.WaitForReady({"adapter"}));
  Play(messages, processes.url());
  EXPECT_TRUE(processes.SpinUntil([&] { return frames == 10 && !findings.empty(); }));
  EXPECT_THAT(findings,
              Contains(HasSubstr("1 pose or time was ignored: 1 x /tf#tf2_msgs.TFMessage: "
                                 "TFMessage, the pose of 'arm' in 'optical': a pose is")));
}

TEST(Adapter, SaysWhatTheBusOfTheRobotLacks) {
  constexpr int kTooMuch = 1 << 30;
  if (ProbeReceiveBuffer(kTooMuch)) GTEST_SKIP() << "this kernel grants 1 GB";
  const std::string url = MulticastUrl(kTooMuch);
  if (!OpenLcmTransport(*ParseLcmUrl(url))) GTEST_SKIP() << "there is no multicast route";
  ProcessBus processes;
  std::vector<std::string> findings;
  processes.bus().Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process == "adapter") findings = status.findings;
  });
  const auto adapter = processes.Start("adapter", {"--preset", "dimos", "--robot-url", url});
  EXPECT_TRUE(processes.SpinUntil([&] { return !findings.empty(); }));
  EXPECT_THAT(findings, Contains(::testing::AllOf(HasSubstr("the robot's bus at udpm://"),
                                                  HasSubstr("sysctl -w net.core.rmem_max"))));
}

// DimOS and Drake publish on LCM's multicast.
TEST(Adapter, ReadsARobotOnMulticast) {
  const std::string url = MulticastUrl(4 << 20);
  if (!ProbeReceiveBuffer(4 << 20)) GTEST_SKIP() << "this kernel grants less than 4 MB";
  if (!Connect(url)) GTEST_SKIP() << "there is no multicast route";
  ProcessBus processes;
  std::set<int64_t> frames;
  processes.bus().Subscribe<rgbd_frame_t>(
      kRgbdFrameChannel, [&](const rgbd_frame_t& frame) { frames.insert(frame.utime); });
  const auto adapter = processes.Start("adapter", {"--preset", "dimos", "--robot-url", url});
  ASSERT_TRUE(processes.WaitForReady({"adapter"}));
  Play(RoomOfDimos(), url);
  EXPECT_TRUE(processes.SpinUntil([&] { return frames.size() == 10; })) << frames.size();
}

TEST(Adapter, PrintsEveryDefaultOfItsPreset) {
  const TempFolder folder;
  ChildProcess adapter("adapter", {"--preset", "dimos", "--print-config"}, folder.path());
  EXPECT_EQ(adapter.WaitForExit(), 0) << adapter.StandardError();
  const std::string text = adapter.StandardOutput();
  for (const char* part : {"preset: DIMOS", "depth_channel: \"/depth_image#sensor_msgs.Image\"",
                           "pose_channels: \"/tf#tf2_msgs.TFMessage\"", "root: \"world\"",
                           "pair_within_ms: 20", "wait_ms: 200"})
    EXPECT_THAT(text, HasSubstr(part));
  ChildProcess nothing("adapter", {"--print-config"}, folder.path());
  EXPECT_EQ(nothing.WaitForExit(), 0);
}

TEST(Adapter, ReadsTheLineThatDimosWritesToItsInput) {
  const TempFolder folder;
  folder.Write("line.json",
               "{\"topics\": {\"color_image\": \"/front#sensor_msgs.Image\"}, "
               "\"config\": {\"root\": \"map\", \"swap_red_blue\": true}, "
               "\"session\": {}, \"qos\": null}\n");
  const auto run = [&](const std::string& line) {
    const std::string command = line + " | DIMOS_TRANSPORT=lcm " + VISMAP_BIN_DIR +
                                "/vismap-adapter --preset dimos --stdin_config true --print-config";
    return std::make_unique<ChildProcess>("/bin/sh", std::vector<std::string>{"-c", command},
                                          folder.path());
  };
  const auto printed = run("cat " + (folder / "line.json").string());
  EXPECT_EQ(printed->WaitForExit(), 0) << printed->StandardError();
  for (const char* part :
       {"color_channel: \"/front#sensor_msgs.Image\"", "root: \"map\"", "swap_red_blue: true"})
    EXPECT_THAT(printed->StandardOutput(), HasSubstr(part));
  const auto unknown = run("echo '{\"config\": {\"colour\": 1}}'");
  EXPECT_EQ(unknown->WaitForExit(), 2);
  EXPECT_THAT(unknown->StandardError(), HasSubstr("--colour"));
}

TEST(Adapter, ReadsTheCamerasOfItsConfig) {
  ProcessBus processes;
  const std::filesystem::path config = processes.folder() / "two.txtpb";
  std::ofstream(config) << R"(adapter {
    preset: DIMOS
    camera { camera_id: 1 }
    camera { camera_id: 2 color_channel: "none" depth_channel: "/second#sensor_msgs.Image" wait_ms: 300 }
  })";
  const auto printed = processes.Start("adapter", {"--config", config.string(), "--print-config"});
  EXPECT_EQ(printed->WaitForExit(), 0) << printed->StandardError();
  const std::string text = printed->StandardOutput();
  for (const char* part :
       {"camera_id: 1", "camera_id: 2", "depth_channel: \"/second#sensor_msgs.Image\"",
        "wait_ms: 300", "none_values: [0, 65535]", "constant_edges: FIXED_WHEN_UNCHANGED"})
    EXPECT_THAT(text, HasSubstr(part));
  const auto refused = processes.Start("adapter", {"--config", config.string(), "--tf", "/tf"});
  EXPECT_EQ(refused->WaitForExit(), 2);
  EXPECT_THAT(refused->StandardError(), HasSubstr("several cameras"));

  std::map<int, int> frames;
  processes.bus().Subscribe<rgbd_frame_t>(
      kRgbdFrameChannel, [&](const rgbd_frame_t& frame) { ++frames[frame.camera_id]; });
  const auto adapter = processes.Start("adapter", {"--config", config.string()});
  ASSERT_TRUE(processes.WaitForReady({"adapter"}));
  std::vector<RobotMessage> messages;
  for (const RobotMessage& message : RoomOfDimos()) {
    messages.push_back(message);
    if (message.channel != kDepthChannel) continue;
    messages.push_back(message);
    messages.back().channel = "/second#sensor_msgs.Image";
  }
  Play(messages, processes.url());
  EXPECT_TRUE(processes.SpinUntil([&] { return frames[1] == 10 && frames[2] == 10; }));
}

TEST(Adapter, IsToldWhatToConfigure) {
  ProcessBus processes;
  const auto adapter = processes.Start("adapter");
  EXPECT_EQ(adapter->WaitForExit(), 2);
  EXPECT_THAT(adapter->StandardError(), HasSubstr("adapter.preset"));
}

}  // namespace
}  // namespace vismap
