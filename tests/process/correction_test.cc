#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>
#include <vismap/map_reply_t.hpp>

#include "process/room_pipeline.h"
#include "simulation/synthetic_dataset.h"
#include "wire/pose_correction.h"

// A robot whose poses were not right, and what its SLAM system says about them later.

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr char kOdometry[] = "synthetic:room?frames=16&width=160&drift=0.005&turn_drift=0.2";

std::vector<std::string> CorrectingServer(const ProcessBus& processes) {
  const std::string config = (processes.folder() / "server.txtpb").string();
  std::ofstream(config) << "map_server { recover: true save_period_s: 0.2 frame_journal_mb: 256 "
                           "accept_corrections: true checkpoint_frames: 5 save_on_exit: \""
                        << (processes.folder() / "kept.vismap").string() << "\" }";
  return {"--config", config};
}

/// The right poses of the first frames.
pose_correction_t RightPoses(size_t count) {
  PoseCorrection correction;
  for (const FrameHeader& header : MakeHeaders(*ParseSyntheticPath(RoomPipeline::kRoom))) {
    if (correction.poses.size() == count) break;
    correction.camera_id = header.camera_id;
    correction.poses.push_back({header.utime, header.T_W_C});
  }
  return Encode(correction);
}

/// Sends a correction and waits for the answer.
map_reply_t Correct(ProcessBus* processes, pose_correction_t correction, int64_t id) {
  auto answer = std::make_shared<std::optional<map_reply_t>>();
  processes->bus().Subscribe<map_reply_t>(kMapReplyChannel, [answer, id](const map_reply_t& reply) {
    if (reply.request_id == id) *answer = reply;
  });
  correction.request_id = id;
  processes->bus().Publish(kPoseCorrectionChannel, correction);
  EXPECT_TRUE(processes->SpinUntil([&] { return answer->has_value(); }));
  return answer->value_or(map_reply_t{});
}

TEST(Corrections, GiveTheMapOfTheOfflineMapperWithTheRightPosesAlsoAfterACrash) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.dataset = kOdometry;
  pipeline.server_arguments = CorrectingServer(processes);
  pipeline.Start();
  // While frames go on, some poses are corrected, which the rest then corrects, too.
  ASSERT_TRUE(pipeline.WaitForFrames(6));
  const map_reply_t first = Correct(&processes, RightPoses(5), 1);
  EXPECT_TRUE(first.ok) << first.message;
  pipeline.WaitForEnd();
  const std::string right = OfflineRoomHash();
  EXPECT_NE(ServerStatistic(&processes, "hash"), right);
  const map_reply_t second = Correct(&processes, RightPoses(RoomPipeline::kFrames), 2);
  EXPECT_TRUE(second.ok) << second.message;
  EXPECT_EQ(ServerStatistic(&processes, "hash"), right);
  ExpectExporterIsLevel(&processes);

  Crash(pipeline.server.get());
  pipeline.StartServer();
  EXPECT_EQ(ServerStatistic(&processes, "hash"), right);
}

TEST(Corrections, AreRefusedByAServerThatIsNotToldToTakeThem) {
  ProcessBus processes;
  auto server = processes.Start("map-server");
  ASSERT_TRUE(processes.WaitForReady({"map-server"}));
  const map_reply_t reply = Correct(&processes, RightPoses(3), 1);
  EXPECT_FALSE(reply.ok);
  EXPECT_THAT(reply.message, HasSubstr("accept_corrections"));
}

}  // namespace
}  // namespace vismap
