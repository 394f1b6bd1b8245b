// Small sequences in the layout of SceneNN.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/frame_codec.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(SceneNn, ReadsEverything) {
  const TempFolder folder;
  WriteSceneNn(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "scenenn");
  EXPECT_EQ(dataset->name(), "seq");
  ASSERT_EQ(dataset->size(), 3u);
  EXPECT_TRUE(dataset->skipped().empty());
  EXPECT_FALSE(dataset->default_detections_path());
  const SensorFrame frame = ReadOrFail(*dataset, 1);
  EXPECT_EQ(frame.header.frame_number, 2);
  EXPECT_EQ(frame.header.utime, 200000);
  EXPECT_EQ(frame.header.camera, (PinholeCamera{16, 12, 20, 21, 8, 6}));
  EXPECT_EQ(frame.header.T_W_C.matrix(), RigidMatrix());
  EXPECT_EQ(frame.depth(5, 5), 2000);
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->depth(0, 0), 2.0f);
  EXPECT_GT(decoded->color(6, 2).r, 240);  // red left, green right
  EXPECT_LT(decoded->color(6, 2).b, 20);
  EXPECT_GT(decoded->color(6, 13).g, 240);
}

TEST(SceneNn, UsesTheIndexInTheTrajectoryNotItsOrder) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/trajectory.log",
               std::string("2 2 3\n") + kRigid + "0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->size(), 2u);
  EXPECT_EQ(dataset->Header(0).T_W_C.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(dataset->Header(1).T_W_C.matrix(), RigidMatrix());
  ASSERT_EQ(dataset->skipped().size(), 1u);
  EXPECT_EQ(dataset->skipped()[0].frame_number, 2);
  EXPECT_THAT(dataset->skipped()[0].reason, HasSubstr("no pose of index 1"));
}

TEST(SceneNn, WithoutTimestampsTheRateGivesTheTime) {
  const TempFolder folder;
  WriteSceneNn(folder);
  std::filesystem::remove(folder / "seq/timestamp.txt");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(2).utime, 100000);
}

TEST(SceneNn, FindsDetectionsInTheFolder) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/detections.json", "[]");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  ASSERT_TRUE(dataset->default_detections_path());
  EXPECT_THAT(*dataset->default_detections_path(), HasSubstr("seq/detections.json"));
}

}  // namespace
}  // namespace vismap
