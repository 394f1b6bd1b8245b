#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>

#include "process/room_pipeline.h"
#include "runtime/clock.h"
#include "runtime/transport.h"

// The map in the messages of other robots' programs, on the robot's own bus, read by the Python
// that lcm-gen makes of their types.

namespace vismap {
namespace {

/// The latest message of every channel of a hub.
class LatestMessages {
 public:
  explicit LatestMessages(const std::string& url) {
    auto transport = OpenTcpqTransport(ParseLcmUrl(url)->hub, nullptr);
    if (!transport) throw std::runtime_error(transport.error().message);
    transport_ = std::move(*transport);
    transport_->Subscribe(".*");
  }

  void Receive() {
    const auto sink = [this](const std::string& channel, std::span<const uint8_t> data) {
      messages_[channel].assign(data.begin(), data.end());
    };
    while (transport_->Receive(sink)) {
    }
  }
  const std::map<std::string, std::vector<uint8_t>>& all() const { return messages_; }
  std::vector<uint8_t> of(const std::string& channel) const {
    const auto found = messages_.find(channel);
    return found == messages_.end() ? std::vector<uint8_t>() : found->second;
  }

 private:
  std::unique_ptr<Transport> transport_;
  std::map<std::string, std::vector<uint8_t>> messages_;
};

const std::map<std::string, std::string> kOutputs = {
    {"cloud", "/global_map#sensor_msgs.PointCloud2"},
    {"costmap", "/global_costmap#nav_msgs.OccupancyGrid"},
    {"detections", "/detections_3d#vision_msgs.Detection3DArray"},
    {"drake_cloud", "DRAKE_POINT_CLOUD_vismap"},
    {"deformable", "DRAKE_VIEWER_DEFORMABLE"},
    {"director", "DIRECTOR_TREE_VIEWER_REQUEST_vismap"}};

constexpr char kOutputConfig[] = R"(adapter {
  preset: DIMOS
  publish_period_s: 0.2
  cloud_spacing_m: 0.05
  costmap_unknown: -1
  cloud_channel: "/global_map#sensor_msgs.PointCloud2"
  costmap_channel: "/global_costmap#nav_msgs.OccupancyGrid"
  detections_channel: "/detections_3d#vision_msgs.Detection3DArray"
  drake_cloud_channel: "DRAKE_POINT_CLOUD_vismap"
  drake_objects_channel: "DRAKE_VIEWER_DEFORMABLE"
  director_channel: "DIRECTOR_TREE_VIEWER_REQUEST_vismap"
})";

void WriteBytes(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

/// Writes the latest messages, and what the server says of the same map.
void WriteFacts(ProcessBus* processes, const LatestMessages& robot, const map_reply_t& objects) {
  const std::filesystem::path& folder = processes->folder();
  for (const auto& [name, channel] : kOutputs)
    WriteBytes(folder / "messages" / name, robot.of(channel));
  WriteBytes(folder / "messages" / "objects.json",
             {objects.payload.begin(), objects.payload.end()});
  const auto follow =
      processes->Start("map", {"follow", "--frames", std::to_string(RoomPipeline::kFrames), "--out",
                               (folder / "messages" / "surface.ply").string()});
  EXPECT_EQ(follow->WaitForExit(), 0) << follow->StandardError();
}

/// Waits until all outputs have come, and none has changed for longer than the objects need.
void WaitForQuiet(ProcessBus* processes, LatestMessages* latest) {
  constexpr double kQuiet = 3;  // [s]
  std::map<std::string, std::vector<uint8_t>> before;
  double changed = MonotonicSeconds();
  EXPECT_TRUE(processes->SpinUntil([&] {
    latest->Receive();
    std::map<std::string, std::vector<uint8_t>> now;
    for (const auto& [name, channel] : kOutputs) now[name] = latest->of(channel);
    if (now != before) changed = MonotonicSeconds();
    before = now;
    const bool all = std::none_of(now.begin(), now.end(),
                                  [](const auto& output) { return output.second.empty(); });
    return all && MonotonicSeconds() - changed > kQuiet;
  }));
}

TEST(AdapterOutputs, AreReadOnTheBusOfTheRobot) {
  ProcessBus processes, robot;
  LatestMessages latest(robot.url());
  const std::filesystem::path config = processes.folder() / "outputs.txtpb";
  std::ofstream(config) << kOutputConfig;
  const auto adapter =
      processes.Start("adapter", {"--config", config.string(), "--robot-url", robot.url()});
  RoomPipeline pipeline(&processes);
  pipeline.Start();
  pipeline.WaitForEnd();
  ASSERT_TRUE(pipeline.WaitForFrames(RoomPipeline::kFrames));

  // The server publishes what it answers with: the surface, and then the objects.
  EXPECT_TRUE(Ask(&processes, "mesh", "digest").ok);
  const map_reply_t objects = Ask(&processes, "objects");
  EXPECT_TRUE(objects.ok) << objects.message;
  WaitForQuiet(&processes, &latest);
  for (const auto& [channel, bytes] : latest.all())
    EXPECT_TRUE(channel == "STATUS" ||
                std::any_of(kOutputs.begin(), kOutputs.end(),
                            [&, &name = channel](const auto& o) { return o.second == name; }))
        << channel << " came on the bus of the robot";
  const std::string source = VISMAP_SOURCE_DIR, path = processes.folder().string();
  std::filesystem::create_directories(processes.folder() / "types");
  const std::string types = std::string(LCM_GEN) + " --python --ppath " + path + "/types " +
                            source + "/lcmtypes/foreign/*.lcm";
  ASSERT_EQ(std::system(types.c_str()), 0) << types;
  const std::string check = "PYTHONDONTWRITEBYTECODE=1 python3 " + source +
                            "/tests/process/check_map_outputs.py " + path + "/types " + path +
                            "/messages";
  // On a busy computer the newest objects come late.
  bool equal = false;
  for (int attempt = 0; attempt < 5 && !equal; ++attempt) {
    if (attempt > 0) WaitForQuiet(&processes, &latest);
    WriteFacts(&processes, latest, objects);
    equal = std::system(check.c_str()) == 0;
  }
  EXPECT_TRUE(equal) << check;
}

}  // namespace
}  // namespace vismap
