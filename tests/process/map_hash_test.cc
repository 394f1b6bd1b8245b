#include <gtest/gtest.h>

#include "process/room_pipeline.h"

// The same frames give the same map: in one process and in several, with one thread and with two,
// and after crashes.

namespace vismap {
namespace {

TEST(MapHash, IsTheSameOfflineAndLiveWithOneThreadAndTwo) {
  const std::string offline = OfflineRoomHash("1");
  EXPECT_EQ(OfflineRoomHash("2"), offline);
  for (const char* threads : {"1", "2"}) {
    ProcessBus processes({"--socket-buffer-bytes", "16384"});
    RoomPipeline pipeline(&processes);
    pipeline.server_arguments = {"--threads", threads};
    pipeline.Start();
    pipeline.WaitForEnd();
    EXPECT_TRUE(pipeline.WaitForFrames(RoomPipeline::kFrames));
    EXPECT_EQ(ServerStatistic(&processes, "hash"), offline);
  }
}

TEST(MapHash, IsTheSameOfflineAndLiveWhenClassesAreLeftOut) {
  const TempFolder folder;
  folder.Write("still.txtpb", "refine { leave_out_classes: [\"chair\", \"63\"] }\n");
  const std::vector<std::string> config{"--config", (folder / "still.txtpb").string()};
  const std::string offline = OfflineRoomHash("2", RoomPipeline::kRoom, config);
  EXPECT_NE(offline, OfflineRoomHash());
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.segmenter_arguments = config;
  pipeline.Start();
  EXPECT_TRUE(pipeline.WaitForFrames(4));
  Crash(pipeline.server.get());  // so that frames are sent and processed again
  pipeline.StartServer();
  pipeline.WaitForEnd();
  EXPECT_EQ(ServerStatistic(&processes, "hash"), offline);
}

}  // namespace
}  // namespace vismap
