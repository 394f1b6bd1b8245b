#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <vismap/process_status_t.hpp>

#include "process/room_pipeline.h"
#include "runtime/transport.h"

// A prefix before the names of all channels, --channel-prefix.

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// How many messages each process has rejected, by its STATUS.
using RejectedCounts = std::map<std::string, int64_t>;

void CountRejected(ProcessBus* processes, RejectedCounts* counts) {
  processes->bus().Subscribe<process_status_t>(kStatusChannel, [counts](const auto& status) {
    int64_t& sum = (*counts)[status.source] = 0;
    for (size_t i = 0; i < status.counter_names.size(); ++i) {
      if (status.counter_names[i].ends_with(".rejected")) sum += status.counter_values[i];
    }
  });
}

/// Publishes what is no message of ours on all our channels, without a prefix.
void DisturbEveryChannel(const std::string& url) {
  const auto transport = OpenTcpqTransport(ParseLcmUrl(url)->hub, nullptr);
  ASSERT_TRUE(transport) << transport.error().message;
  const std::vector<uint8_t> bytes(100, 7);
  for (const Channel& channel : kAllChannels)
    EXPECT_TRUE((*transport)->Publish(channel.name, bytes));
}

TEST(ChannelPrefix, TwoPipelinesOnOneHubDoNotDisturbEachOther) {
  ProcessBus hub;
  ProcessBus first(hub, "first/"), second(hub, "SECOND_");
  RoomPipeline left(&first), right(&second);
  right.detections = "none";
  RejectedCounts rejected;
  CountRejected(&first, &rejected);
  left.Start();
  right.Start();
  EXPECT_TRUE(left.WaitForFrames(2));
  DisturbEveryChannel(hub.url());
  left.WaitForEnd();
  right.WaitForEnd();
  EXPECT_TRUE(left.WaitForFrames(RoomPipeline::kFrames));
  EXPECT_TRUE(right.WaitForFrames(RoomPipeline::kFrames));
  EXPECT_EQ(ServerStatistic(&first, "hash"), OfflineRoomHash());
  EXPECT_EQ(ServerStatistic(&second, "hash"),
            OfflineRoomHash("2", RoomPipeline::kRoom, {"--detections", "none"}));
  ExpectExporterIsLevel(&first);
  EXPECT_TRUE(rejected.contains("map-server"));
  for (const auto& [name, count] : rejected) EXPECT_EQ(count, 0) << name;
  EXPECT_FALSE(hub.peers().all().contains("map-server"));

  const auto digests = first.Start("map", {"digests"});
  EXPECT_EQ(digests->WaitForExit(), 0) << digests->StandardError();
  const auto doctor = hub.Start("doctor", {"--seconds", "2"});
  EXPECT_EQ(doctor->WaitForExit(), 1);
  EXPECT_THAT(doctor->StandardOutput(), HasSubstr("--channel-prefix 'first/'"));
  EXPECT_THAT(doctor->StandardOutput(), HasSubstr("--channel-prefix 'SECOND_'"));
}

TEST(ChannelPrefix, LogsHaveIt) {
  const TempFolder folder;
  const std::string log = (folder / "room.lcmlog").string();
  const auto run = [&](const std::string& program, std::vector<std::string> arguments) {
    ChildProcess process(program, arguments, folder.path());
    const int code = process.WaitForExit().value_or(-1);
    return std::pair(code, process.StandardError());
  };
  const std::vector<std::string> prefix = {"--channel-prefix", "my.robot/"};
  std::ofstream(folder / "bus.txtpb") << "pipeline { channel_prefix: \"my.robot/\" }\n";
  const auto [written, why] =
      run("log", {"from-dataset", RoomPipeline::kRoom, "--out", log, prefix[0], prefix[1]});
  ASSERT_EQ(written, 0) << why;
  EXPECT_EQ(OfflineRoomHash("2", log, {"--config", (folder / "bus.txtpb").string()}),
            OfflineRoomHash());
  const auto [without, sentence] =
      run("offline-mapper", {"--dataset", log, "--out", (folder / "out").string()});
  EXPECT_EQ(without, 3);
  EXPECT_THAT(sentence, HasSubstr("--channel-prefix 'my.robot/'"));
  EXPECT_EQ(run("log", {"verify", log, prefix[0], prefix[1]}).first, 0);
  const std::string part = (folder / "part.lcmlog").string();
  EXPECT_EQ(
      run("log", {"cut", log, "--channels", "RGBD_FRAME", "--out", part, prefix[0], prefix[1]})
          .first,
      0);
  EXPECT_EQ(OfflineRoomHash("2", part, {"--detections", "none", prefix[0], prefix[1]}),
            OfflineRoomHash("2", RoomPipeline::kRoom, {"--detections", "none"}));
}

TEST(ChannelPrefix, ABridgeCarriesIt) {
  ProcessBus here, there;
  ProcessBus robot(here, "robot/"), base(there, "robot/");
  const auto bridge =
      robot.Start("bridge", {"--remote-url", there.url(), "--send", "SEGMENTED_FRAME,MAP_REQUEST",
                             "--receive", "MAP_COMMIT,MAP_REPLY"});
  RoomPipeline pipeline(&robot, &base);
  pipeline.Start();
  pipeline.WaitForEnd();
  EXPECT_EQ(ServerStatistic(&base, "hash"), OfflineRoomHash());
}

TEST(ChannelPrefix, AnImpossibleOneIsAWrongUse) {
  const TempFolder folder;
  for (const std::string bad :
       {"a b", "over*all", "very-long-very-long-very-long-very-long-very-long-/"}) {
    ChildProcess hub("hub", {"--listen", "127.0.0.1:0", "--channel-prefix", bad}, folder.path());
    EXPECT_EQ(hub.WaitForExit(), 2) << bad;
    EXPECT_THAT(hub.StandardError(), HasSubstr("pipeline.channel_prefix (--channel-prefix)"));
  }
}

}  // namespace
}  // namespace vismap
