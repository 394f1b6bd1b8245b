#include "plausibility/sequence_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A frame that looks at a wall 2 m in front of the start, from `x` m beside it.
FrameHeader HeaderAt(double x, int64_t number, CameraId camera = CameraId{0}) {
  FrameHeader header{.utime = 33'333 * number,
                     .camera_id = camera,
                     .frame_number = number,
                     .camera = {160, 120, 130, 130, 79.5, 59.5}};
  header.T_W_C.translation().x() = x;
  return header;
}

Image<float> Wall() { return Image<float>(160, 120, 2.0F); }

TEST(SequenceCheck, SaysNothingAboutAGoodSequence) {
  SequenceCheck check({0.1, 5});
  for (int i = 0; i < 40; ++i) check.Add(HeaderAt(0.02 * i, i), Wall(), 0.001);
  EXPECT_THAT(check.Findings(), IsEmpty());
}

TEST(SequenceCheck, CamerasAreJudgedOneByOne) {
  SequenceCheck check({0.1, 5});
  for (int i = 0; i < 40; ++i) {
    check.Add(HeaderAt(0.02 * i, i), Wall(), 0.001);
    FrameHeader other = HeaderAt(-50 + 0.02 * i, i, CameraId{7});
    other.camera.fx = other.camera.fy = 30;
    check.Add(other, Wall(), 0.001);
  }
  EXPECT_THAT(check.Findings(), ElementsAre(AllOf(HasSubstr("camera 7: "), HasSubstr("fx = 30"))));
}

TEST(SequenceCheck, DepthIsForgottenButPosesAreNot) {
  SequenceCheck check({0.1, 5});
  for (int i = 0; i < 8; ++i) check.Add(HeaderAt(0.02 * i, i), Image<float>(160, 120, 50), 0.01);
  EXPECT_THAT(check.Findings(), ElementsAre(HasSubstr("0.01 m per step")));
  check.ForgetDepth();
  EXPECT_THAT(check.Findings(), IsEmpty());
}

// What is known beforehand of the number of frames changes which images are needed, not which are
// compared.
TEST(PoseCheck, FewImagesAreNeededWhenTheNumberOfFramesIsKnown) {
  for (const int frames : {5, 23, 24, 100, 1000}) {
    PoseCheck unknown, known(frames);
    int needed = 0;
    for (int i = 0; i < frames; ++i) {
      // The wall is where it is, but the camera is said to go back and forth along its view.
      FrameHeader header = HeaderAt(0, i);
      header.T_W_C.translation().z() = i % 2;
      unknown.Add(header, Wall());
      needed += known.NeedsDepth() ? 1 : 0;
      known.Add(header, known.NeedsDepth() ? Wall() : Image<float>());
    }
    EXPECT_LT(needed, 24) << frames;
    EXPECT_EQ(unknown.Compare().all.points, known.Compare().all.points) << frames;
    EXPECT_GT(known.Compare().all.points, 0) << frames;
    EXPECT_EQ(unknown.Finding(), known.Finding()) << frames;
  }
}

TEST(PoseCheck, AnImageThatCannotBeReadIsLeftOut) {
  PoseCheck check;
  for (int i = 0; i < 100; ++i)
    check.Add(HeaderAt(0.02 * i, i), i % 3 == 1 ? Image<float>() : Wall());
  EXPECT_EQ(check.Finding(), std::nullopt);
}

}  // namespace
}  // namespace vismap
