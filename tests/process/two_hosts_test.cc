#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "process/room_pipeline.h"

// Two simulated computers (network namespaces) with a lossy network between them: camera, detector
// and segmenter on one, map server and exporter on the other.

namespace vismap {
namespace {

constexpr char kFastRoom[] = "synthetic:room?frames=30&width=320&rate=10";
constexpr int kRoomFrames = 30;

bool Run(const std::string& command) { return std::system((command + " 2>&1").c_str()) == 0; }

std::string OutputOf(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

/// Two network namespaces connected by a cable that loses `loss` of 1000 Ethernet frames in each
/// direction. The destructor removes them.
class TwoHosts {
 public:
  explicit TwoHosts(int loss) {
    const std::string a = camera_.network_namespace, b = map_.network_namespace;
    const std::string lossy =
        "nft 'add table netdev loss; add chain netdev loss in { type filter hook ingress device "
        "cable priority 0; }; add rule netdev loss in numgen random mod 1000 < " +
        std::to_string(loss) + " counter drop'";
    good_ = Run("ip netns add " + a) && Run("ip netns add " + b) &&
            Run("ip -n " + a + " link add cable type veth peer name cable netns " + b);
    for (const Host& host : {camera_, map_}) {
      const std::string in = "ip -n " + host.network_namespace + " ";
      good_ = good_ && Run(in + "link set lo up") &&
              Run(in + "addr add " + host.address + "/24 dev cable") &&
              Run(in + "link set cable gso_max_segs 1") && Run(in + "link set cable up") &&
              Run("ip netns exec " + host.network_namespace + " " + lossy);
    }
  }
  ~TwoHosts() {
    Run("ip netns del " + camera_.network_namespace);
    Run("ip netns del " + map_.network_namespace);
  }
  TwoHosts(const TwoHosts&) = delete;
  TwoHosts& operator=(const TwoHosts&) = delete;

  bool good() const { return good_; }
  const Host& camera() const { return camera_; }
  const Host& map() const { return map_; }
  /// Number of lost packets in both directions.
  int Lost() const {
    int lost = 0;
    for (const Host& host : {camera_, map_}) {
      const std::string rules =
          OutputOf("ip netns exec " + host.network_namespace + " nft list table netdev loss");
      const size_t found = rules.find("packets ");
      if (found != std::string::npos) lost += std::atoi(rules.c_str() + found + 8);
    }
    return lost;
  }

 private:
  Host camera_{"vismap-a-" + std::to_string(getpid()), "10.77.0.1"};
  Host map_{"vismap-b-" + std::to_string(getpid()), "10.77.0.2"};
  bool good_ = false;
};

std::string WhyNot() {
  if (geteuid() != 0) return "needs root, to make network namespaces";
  if (!Run("command -v ip >/dev/null && command -v nft >/dev/null")) {
    return "needs the packages iproute2 and nftables";
  }
  return TwoHosts(0).good() ? "" : "this kernel has no network namespaces, veth or nft ingress";
}

std::unique_ptr<ChildProcess> StartBridge(ProcessBus* camera, const ProcessBus& map) {
  return camera->Start(
      "bridge", {"--remote-url", map.url(), "--send", "SEGMENTED_FRAME,MAP_REQUEST", "--receive",
                 "MAP_COMMIT,MAP_REPLY"});
}

/// Runs the pipeline at ten frames per second without sending a frame again; returns the map hash.
std::string MapAtTenHertz(int loss) {
  const TwoHosts hosts(loss);
  ProcessBus camera({}, {hosts.camera().network_namespace, "127.0.0.1"}), map({}, hosts.map());
  const auto bridge = StartBridge(&camera, map);
  const auto server = map.Start("map-server");
  const auto exporter = map.Start("octomap-exporter");
  const auto segmenter = camera.Start("depth-segmenter", {"--detections", "required"});
  const auto detector = camera.Start("detector", {"--dataset", kFastRoom});
  int integrated = 0;
  camera.bus().Subscribe<frame_commit_t>(kMapCommitChannel, [&](const frame_commit_t& commit) {
    integrated += commit.status == frame_commit_t::STATUS_INTEGRATED ? 1 : 0;
  });
  const auto replay =
      camera.Start("sensor-replay", {"--dataset", kFastRoom, "--wait-for",
                                     "map-server,depth-segmenter,detector,octomap-exporter"});
  EXPECT_TRUE(camera.SpinUntil([&] { return integrated == kRoomFrames; })) << integrated;
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  ExpectExporterIsLevel(&map);
  EXPECT_EQ(camera.bus().counters().at("MAP_COMMIT").lost, 0);
  EXPECT_TRUE(loss > 0 || hosts.Lost() == 0);
  EXPECT_TRUE(loss < 10 || hosts.Lost() > 0) << "some of about a thousand packets must be lost";
  return ServerStatistic(&camera, "hash");
}

TEST(TwoHosts, MapIsTheSameAtTenHertzAlthoughPacketsAreLost) {
  if (const std::string why = WhyNot(); !why.empty()) GTEST_SKIP() << why;
  const std::string offline = OfflineRoomHash("2", kFastRoom);
  for (const int loss : {0, 1, 10}) {
    SCOPED_TRACE(std::to_string(loss) + " of 1000 packets lost");
    EXPECT_EQ(MapAtTenHertz(loss), offline);
  }
}

TEST(TwoHosts, LockstepOverALossyNetwork) {
  if (const std::string why = WhyNot(); !why.empty()) GTEST_SKIP() << why;
  const TwoHosts hosts(10);
  ProcessBus camera({}, {hosts.camera().network_namespace, "127.0.0.1"}), map({}, hosts.map());
  const auto bridge = StartBridge(&camera, map);
  RoomPipeline pipeline(&camera, &map);
  pipeline.Start();
  pipeline.WaitForEnd();
  EXPECT_EQ(ServerStatistic(&camera, "hash"), OfflineRoomHash());
  EXPECT_GT(hosts.Lost(), 0);
}

}  // namespace
}  // namespace vismap
