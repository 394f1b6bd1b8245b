#include "wire/pose_correction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

PoseCorrection SomeCorrection() {
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
  turned.translation() = Eigen::Vector3d(1, -2, 3);
  return {CameraId{2}, true, {{100, turned}, {300, Pose::Identity()}, {900, turned.inverse()}}};
}

std::string ErrorOf(const pose_correction_t& message) {
  const Result<PoseCorrection> decoded = Decode(message);
  return decoded ? "" : decoded.error().message;
}

TEST(PoseCorrectionMessage, ComesBackAsItWasSent) {
  const PoseCorrection sent = SomeCorrection();
  pose_correction_t message = Encode(sent);
  std::swap(message.poses[0], message.poses[2]);
  const auto unpacked = Unpack<pose_correction_t>(Pack(message), kPoseCorrectionChannel.max_bytes);
  ASSERT_TRUE(unpacked) << unpacked.error().message;
  const Result<PoseCorrection> got = Decode(*unpacked);
  ASSERT_TRUE(got) << got.error().message;
  EXPECT_EQ(got->camera_id, sent.camera_id);
  EXPECT_TRUE(got->interpolated);
  ASSERT_EQ(got->poses.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(got->poses[i].utime, sent.poses[i].utime) << "by time";
    EXPECT_EQ(got->poses[i].T_W_C.matrix(), sent.poses[i].T_W_C.matrix());
  }
}

TEST(PoseCorrectionMessage, OfTheLargestNumberOfPosesFitsTheChannel) {
  PoseCorrection correction;
  for (int32_t i = 0; i < kMaxCorrectedPoses; ++i)
    correction.poses.push_back({i, Pose::Identity()});
  const pose_correction_t message = Encode(correction);
  EXPECT_TRUE(Decode(message));
  EXPECT_LT(static_cast<size_t>(message.getEncodedSize()) + 300, kPoseCorrectionChannel.max_bytes);
}

TEST(PoseCorrectionMessage, IsRefusedWithTheFieldThatIsWrong) {
  const pose_correction_t good = Encode(SomeCorrection());
  EXPECT_EQ(ErrorOf(good), "");
  pose_correction_t message = good;
  message.camera_id = -1;
  EXPECT_THAT(ErrorOf(message), HasSubstr("camera_id: expected 0 or more, found -1"));
  message = good;
  message.mode = 7;
  EXPECT_THAT(ErrorOf(message), HasSubstr("mode: expected 0 or 1, found 7"));
  message = good;
  message.poses[1].T_W_C[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(message), HasSubstr("utime 300 cannot be used: pose has a NaN"));
  message = good;
  message.poses[1].T_W_C[0] = 2;
  EXPECT_THAT(ErrorOf(message), HasSubstr("not rigid"));
  message = good;
  message.poses[2].utime = 100;
  EXPECT_THAT(ErrorOf(message), HasSubstr("two poses for utime 100"));
  message = good;
  message.poses.clear();
  message.n_poses = 0;
  EXPECT_THAT(ErrorOf(message), HasSubstr("n_poses: expected 1 to 200000, found 0"));
}

}  // namespace
}  // namespace vismap
