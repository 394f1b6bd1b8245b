#include <gtest/gtest.h>

#include "process/room_pipeline.h"

// The same frames give the same map: in one process, in many, with one thread, with two, and after
// crashes.

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

}  // namespace
}  // namespace vismap
