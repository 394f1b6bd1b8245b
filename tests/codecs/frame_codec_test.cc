#include "codecs/frame_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "codecs/color_codec.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

SensorFrame SmallFrame() {
  SensorFrame frame;
  frame.header = {.utime = 123,
                  .camera_id = CameraId{4},
                  .frame_number = 9,
                  .camera = {.width = 4, .height = 2, .fx = 5, .fy = 5, .cx = 2, .cy = 1}};
  frame.depth = Image<uint16_t>(4, 2, 1500);
  frame.color = EncodeJpeg(Image<Rgb8>(4, 2, Rgb8{10, 200, 30}));
  return frame;
}

TEST(DecodeFrame, GivesMetresAndColour) {
  SensorFrame frame = SmallFrame();
  frame.depth(0, 1) = 0;
  frame.depth(1, 3) = 65535;
  frame.depth(1, 2) = 65534;
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->depth(0, 0), 1.5f);
  EXPECT_TRUE(std::isnan(decoded->depth(0, 1)));
  EXPECT_TRUE(std::isnan(decoded->depth(1, 3)));
  EXPECT_EQ(decoded->depth(1, 2), 65.534f);
  EXPECT_NEAR(decoded->color(1, 3).g, 200, 3);
  EXPECT_EQ(decoded->header.frame_number, 9);
  EXPECT_EQ(decoded->header.camera_id, CameraId{4});
}

TEST(DecodeFrame, UsesTheDepthUnit) {
  SensorFrame frame = SmallFrame();
  frame.depth_unit_m = 1.0 / 5000;
  EXPECT_FLOAT_EQ(DecodeFrame(frame)->depth(0, 0), 0.3f);
}

TEST(DecodeFrame, WorksWithoutColour) {
  SensorFrame frame = SmallFrame();
  frame.color.clear();
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(decoded->color.empty());
}

TEST(DecodeFrame, DamagedColourCostsOnlyTheColour) {
  for (const size_t kept : {size_t{1}, size_t{20}, SmallFrame().color.size() - 3}) {
    SensorFrame frame = SmallFrame();
    frame.color.resize(kept);
    const Result<RgbdFrame> decoded = DecodeFrame(frame);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_TRUE(decoded->color.empty());
    EXPECT_THAT(decoded->color_problem, HasSubstr("frame utime 123 of camera 4: colour: JPEG"));
    EXPECT_EQ(decoded->depth.width(), 4);
  }
  EXPECT_EQ(DecodeFrame(SmallFrame())->color_problem, "");
}

TEST(DecodeFrame, NamesWhatIsWrong) {
  const auto error_after = [](const auto& change) {
    SensorFrame frame = SmallFrame();
    change(&frame);
    const Result<RgbdFrame> decoded = DecodeFrame(frame);
    return decoded ? std::string("no error") : decoded.error().message;
  };
  EXPECT_THAT(error_after([](SensorFrame* f) { f->color = EncodeJpeg(Image<Rgb8>(5, 2)); }),
              HasSubstr("frame utime 123 of camera 4: colour: the image is 5x2; expected 4x2"));
  EXPECT_THAT(error_after([](SensorFrame* f) { f->depth = Image<uint16_t>(4, 3); }),
              HasSubstr("depth is 4x3 but the camera 4x2"));
  EXPECT_THAT(error_after([](SensorFrame* f) { f->header.camera.fx = 0; }), HasSubstr("focal"));
  for (const double unit : {0.0, -1.0, 2.0, std::nan("")}) {
    EXPECT_THAT(error_after([unit](SensorFrame* f) { f->depth_unit_m = unit; }),
                HasSubstr("depth unit"));
  }
}

}  // namespace
}  // namespace vismap
