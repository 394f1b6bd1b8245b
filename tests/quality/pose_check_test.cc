// Whether wrong poses are noticed, and right ones left in peace, on whole sequences.
#include "plausibility/pose_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/pipelines.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;
using PoseMap = std::function<Pose(const Pose&)>;

std::optional<std::string> FindingOf(const std::string& sequence, const DatasetOptions& options,
                                     const PoseMap& mistake) {
  const testing_support::InputSequence input(sequence, options);
  PoseCheck check;
  for (size_t i = 0; i < input.size(); ++i) {
    RgbdFrame frame = input.Read(i).frame;
    frame.header.T_W_C = mistake(frame.header.T_W_C);
    check.Add(frame.header, frame.depth);
  }
  return check.Finding();
}

Pose Right(const Pose& T_W_C) { return T_W_C; }

Pose WithRotation(const Pose& T_W_C, const Eigen::Matrix3d& R) {
  Pose other = T_W_C;
  other.linear() = R;
  return other;
}

struct Mistake {
  const char* words;  // of the cause that must be named
  PoseMap make;
};

const std::vector<Mistake>& Mistakes() {
  static const std::vector<Mistake> mistakes{
      {"world-to-camera", [](const Pose& T) { return T.inverse(); }},
      {"OpenGL",
       [](const Pose& T) {
         return WithRotation(T, T.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal());
       }},
      {"divided by 1000",
       [](const Pose& T) {
         Pose other = T;
         other.translation() *= 1000;
         return other;
       }},
      {"w x y z",
       [](const Pose& T) {
         // Written as w x y z, read as x y z w.
         const Eigen::Quaterniond q(T.linear());
         return WithRotation(T, Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix());
       }},
  };
  return mistakes;
}

TEST(PoseCheck, RightPosesAreLeftInPeace) {
  const DatasetOptions all;
  EXPECT_EQ(FindingOf("synthetic:room?width=160", all, Right), std::nullopt);
  EXPECT_EQ(FindingOf("synthetic:room?width=160&frames=10", all, Right), std::nullopt);
  EXPECT_EQ(FindingOf("synthetic:room?width=160&pose_noise=0.02&depth_noise=2", all, Right),
            std::nullopt);
  EXPECT_EQ(FindingOf("synthetic:office?width=160&frames=200", all, Right), std::nullopt);
  EXPECT_EQ(FindingOf("synthetic:room?width=160&tours=2&remove=8@81", all, Right), std::nullopt);
}

TEST(PoseCheck, EveryMistakeIsNoticedAndNamed) {
  for (const Mistake& mistake : Mistakes()) {
    EXPECT_THAT(FindingOf("synthetic:room?width=160", {}, mistake.make),
                Optional(HasSubstr(mistake.words)));
  }
}

// Ten frames of a camera that has hardly moved.
TEST(PoseCheck, LittleMotionIsEnough) {
  const std::string room = "synthetic:room?width=160";
  const DatasetOptions few{.stride = 2, .max_frames = 10};
  EXPECT_EQ(FindingOf(room, few, Right), std::nullopt);
  EXPECT_EQ(FindingOf(room + "&pose_noise=0.02&depth_noise=2", few, Right), std::nullopt);
  for (const Mistake& mistake : Mistakes())
    EXPECT_THAT(FindingOf(room, few, mistake.make), Optional(HasSubstr(mistake.words)));
}

TEST(PoseCheck, RecordedSequences) {
  const auto recorded = testing_support::RecordedSequence("7scenes");
  if (!recorded) GTEST_SKIP() << "VISMAP_DATA names no folder with recorded sequences";
  EXPECT_EQ(FindingOf(*recorded, {}, Right), std::nullopt);
  for (const Mistake& mistake : Mistakes())
    EXPECT_THAT(FindingOf(*recorded, {}, mistake.make), Optional(HasSubstr(mistake.words)));
}

}  // namespace
}  // namespace vismap
