#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/process_status_t.hpp>

#include "process/room_pipeline.h"

// A bridge between two buses, as between two computers.

namespace vismap {
namespace {

using ::testing::HasSubstr;

std::unique_ptr<ChildProcess> StartBridge(ProcessBus* here, const ProcessBus& there,
                                          const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"--remote-url", there.url()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return here->Start("bridge", arguments);
}

std::unique_ptr<ChildProcess> StartMapBridge(ProcessBus* here, const ProcessBus& there) {
  return StartBridge(
      here, there, {"--send", "SEGMENTED_FRAME,MAP_REQUEST", "--receive", "MAP_COMMIT,MAP_REPLY"});
}

/// The STATUS messages on a bus: the latest of each process, and how often a message arrived twice.
class StatusBook {
 public:
  explicit StatusBook(Bus* bus) {
    bus->Subscribe<process_status_t>(kStatusChannel, [this](const process_status_t& status) {
      repeated_ += seen_.insert({status.source, status.start_utime, status.seq}).second ? 0 : 1;
      last_[status.process] = status;
    });
  }
  int repeated() const { return repeated_; }
  bool Has(const std::string& process) const { return last_.contains(process); }
  std::string Message(const std::string& process) const {
    return Has(process) ? last_.at(process).message : "";
  }
  int64_t Counter(const std::string& process, const std::string& name) const {
    if (!Has(process)) return -1;
    const process_status_t& status = last_.at(process);
    for (size_t i = 0; i < status.counter_names.size(); ++i) {
      if (status.counter_names[i] == name) return status.counter_values[i];
    }
    return -1;
  }

 private:
  std::set<std::tuple<std::string, int64_t, int64_t>> seen_;
  std::map<std::string, process_status_t> last_;
  int repeated_ = 0;
};

TEST(Bridge, PipelineOverTwoBusesGivesTheMapOfOneProcess) {
  ProcessBus camera_side, map_side;
  StatusBook heard_at_camera(&camera_side.bus()), heard_at_map(&map_side.bus());
  const auto bridge = StartMapBridge(&camera_side, map_side);
  RoomPipeline pipeline(&camera_side, &map_side);
  pipeline.Start();
  pipeline.WaitForEnd();
  EXPECT_EQ(pipeline.integrated(), RoomPipeline::kFrames);
  EXPECT_EQ(ServerStatistic(&camera_side, "hash"), OfflineRoomHash())
      << "requested across the bridge";
  map_side.bus().Spin(0);
  for (const char* process : {"map-server", "octomap-exporter", "depth-segmenter", "bridge"}) {
    EXPECT_TRUE(heard_at_camera.Has(process)) << process;
    EXPECT_TRUE(map_side.SpinUntil([&] { return heard_at_map.Has(process); })) << process;
  }
  EXPECT_EQ(heard_at_camera.repeated(), 0);
  EXPECT_EQ(heard_at_map.repeated(), 0);
  bridge->Signal(SIGTERM);
  EXPECT_EQ(bridge->WaitForExit(), 0) << bridge->StandardError();
}

TEST(Bridge, SurvivesKilledHubsAndAKilledBridge) {
  ProcessBus camera_side, map_side;
  auto bridge = StartMapBridge(&camera_side, map_side);
  RoomPipeline pipeline(&camera_side, &map_side);
  pipeline.Start();
  ASSERT_TRUE(pipeline.WaitForFrames(3));
  map_side.RestartHub();
  ASSERT_TRUE(pipeline.WaitForFrames(6));
  camera_side.RestartHub();
  ASSERT_TRUE(pipeline.WaitForFrames(9));
  Crash(bridge.get());
  bridge = StartMapBridge(&camera_side, map_side);
  pipeline.WaitForEnd();
  EXPECT_EQ(ServerStatistic(&map_side, "hash"), OfflineRoomHash());
}

map_delta_t Delta(int64_t revision, size_t bytes) {
  map_delta_t delta{};
  delta.revision = revision;
  delta.payload.assign(bytes, 1);
  delta.payload_size = static_cast<int32_t>(bytes);
  return delta;
}

/// Waits until the bus has connected to the new hub and receives its own message, so that the hub
/// has its subscriptions.
void JoinAgain(ProcessBus* processes) {
  bool heard = false;
  processes->bus().Subscribe<map_request_t>(kMapRequestChannel,
                                            [&](const map_request_t&) { heard = true; });
  EXPECT_TRUE(processes->SpinUntil(
      [&] { return processes->bus().reconnects() > 0 && processes->bus().connected(); }));
  processes->bus().Publish(kMapRequestChannel, map_request_t{});
  EXPECT_TRUE(processes->SpinUntil([&] { return heard; }));
}

struct Outage {
  std::vector<int64_t> got;  ///< revisions of the deltas that arrived, in order
  int64_t dropped = 0, replaced = 0;
};

/// Sends 20 deltas of half a megabyte while the other bus is down; returns what arrives after its
/// restart.
Outage SendWhileAway(const std::string& bridge_config) {
  ProcessBus here, there;
  const TempFolder folder;
  folder.Write("bridge.txtpb", "bridge { " + bridge_config + " }");
  StatusBook book(&here.bus());
  auto outage = std::make_shared<Outage>();
  bool last = false;
  there.bus().Subscribe<map_delta_t>(kMapDeltaChannel, [outage, &last](const map_delta_t& delta) {
    if (delta.revision < 20) outage->got.push_back(delta.revision);
    last = delta.revision == 20;
  });
  const auto bridge = StartBridge(
      &here, there, {"--send", "MAP_DELTA", "--config", (folder / "bridge.txtpb").string()});
  const auto says = [&] { return book.Message("bridge"); };
  EXPECT_TRUE(here.SpinUntil([&] { return book.Has("bridge") && says().empty(); }));
  there.StopHub();
  EXPECT_TRUE(here.SpinUntil([&] { return says().find(there.url()) != std::string::npos; }));
  EXPECT_THAT(says(), HasSubstr("no connection to"));
  for (int i = 0; i < 20; ++i) here.bus().Publish(kMapDeltaChannel, Delta(i, kMegabyte / 2));
  const auto count = [&](const char* what) {
    return std::max<int64_t>(0, book.Counter("bridge", std::string("send.MAP_DELTA.") + what));
  };
  EXPECT_TRUE(here.SpinUntil(
      [&] { return count("forwarded") + count("dropped") + count("replaced") == 20; }));
  outage->dropped = count("dropped");
  outage->replaced = count("replaced");
  there.RestartHub();
  // The bridge is back before the reader, and sends what it has queued.
  EXPECT_TRUE(here.SpinUntil(
      [&] { return says().empty() && book.Counter("bridge", "send.queued_bytes") == 0; }));
  JoinAgain(&there);
  here.bus().Publish(kMapDeltaChannel, Delta(20, 1));
  EXPECT_TRUE(there.SpinUntil([&] { return last; }));
  return *outage;
}

TEST(BridgeWithoutTheOtherBus, QueuesLosslessMessagesUpToItsLimit) {
  const Outage outage = SendWhileAway("queue_mb: 4 lossless: \"MAP_DELTA\"");
  EXPECT_EQ(outage.dropped,
            13);  // seven messages of slightly more than half a megabyte fit into four megabytes
  std::vector<int64_t> expected(7);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(outage.got, expected);
}

TEST(BridgeWithoutTheOtherBus, KeepsTheLatestOnly) {
  const Outage outage = SendWhileAway("latest: \"MAP_DELTA\"");
  EXPECT_EQ(outage.dropped, 0);
  EXPECT_LE(outage.got.size(), 1U) << "or none, if the next one arrived before the reconnection";
  EXPECT_EQ(outage.replaced, 19);
}

TEST(Bridge, ForwardsFromAMulticastBusToAHub) {
  const std::string url =
      "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0";
  auto udpm = Bus::Open({url, "sensor", 1, nullptr});
  if (!udpm) GTEST_SKIP() << udpm.error().message;
  ProcessBus there;
  int received = 0;
  there.bus().Subscribe<map_delta_t>(kMapDeltaChannel, [&](const map_delta_t&) { ++received; });
  ChildProcess bridge("bridge",
                      {"--lcm-url", url, "--remote-url", there.url(), "--send", "MAP_DELTA"},
                      there.folder());
  ASSERT_TRUE(there.SpinUntil([&] { return there.peers().IsAlive("bridge"); }));
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE((*udpm)->Publish(kMapDeltaChannel, Delta(i, 100 * 1024)));
    ASSERT_TRUE(there.SpinUntil([&] { return received == i + 1; }));
  }
  StatusBook book(udpm->get());
  EXPECT_TRUE(there.SpinUntil([&] {
    (*udpm)->Spin(0);
    return book.Has("hub");
  })) << "status of the other bus";
}

TEST(Bridge, UsageErrorsAreReported) {
  const TempFolder folder;
  const struct {
    std::vector<std::string> arguments;
    const char* says;
  } cases[] = {
      {{}, "--remote-url"},
      {{"--remote-url", "tcpq://localhost:7700"}, "expected a numeric address"},
      {{"--remote-url", "10.0.0.1"}, "expected PROVIDER://"},
      {{"--remote-url", "tcpq://127.0.0.1:7700", "--lcm-url", "tcpq://127.0.0.1:7700"},
       "are the same bus"},
      {{"--remote-url", "tcpq://10.0.0.1:7700", "--send", "RGBD_.*"}, "'RGBD_.*'"},
  };
  for (const auto& expected : cases) {
    ChildProcess process("bridge", expected.arguments, folder.path());
    EXPECT_EQ(process.WaitForExit(), 2) << process.StandardError();
    EXPECT_THAT(process.StandardError(), HasSubstr(expected.says));
  }
}

}  // namespace
}  // namespace vismap
