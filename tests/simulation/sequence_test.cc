#include "simulation/sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/frame_codec.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(SyntheticPath, HasDefaultsAndParameters) {
  const Result<SyntheticOptions> plain = ParseSyntheticPath("synthetic:room");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->frames, 80);
  EXPECT_EQ(plain->width, 640);
  EXPECT_TRUE(plain->noise);
  const Result<SyntheticOptions> office = ParseSyntheticPath("synthetic:office");
  ASSERT_TRUE(office);
  EXPECT_EQ(office->frames, 400);
  EXPECT_EQ(office->width, 640);
  const Result<SyntheticOptions> all =
      ParseSyntheticPath("synthetic:room?frames=20&width=320&noise=none&seed=2&rate=2.5");
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->frames, 20);
  EXPECT_EQ(all->width, 320);
  EXPECT_FALSE(all->noise);
  EXPECT_EQ(all->seed, 2u);
  EXPECT_EQ(all->rate, 2.5);
}

TEST(SyntheticPath, ObjectsComeAndGo) {
  const auto options =
      ParseSyntheticPath("synthetic:room?frames=4&width=160&noise=none&remove=8@3&appear=7@2");
  ASSERT_TRUE(options) << options.error().message;
  const Scene scene = MakeScene(*options);
  const auto shows = [&](int64_t frame, uint16_t id) {
    return FindObject(SceneInFrame(scene, frame), id) != nullptr;
  };
  EXPECT_FALSE(shows(1, 7));
  EXPECT_TRUE(shows(2, 7));
  EXPECT_TRUE(shows(2, 8));
  EXPECT_FALSE(shows(3, 8));
  const auto dataset = MakeSyntheticDataset(*options, {});
  EXPECT_THAT(dataset->default_detections_path().value(), HasSubstr("&remove=8@3&appear=7@2"));
  for (const std::string change : {"remove=8", "remove=8@0", "remove=@3", "appear=x@3", "move=8@3",
                                   "move=8@3,1", "move=8@3,1,2,3"})
    EXPECT_FALSE(ParseSyntheticPath("synthetic:room?" + change)) << change;
  const auto unknown = ParseSyntheticPath("synthetic:room?remove=99@3");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("room has no object 99"));
}

TEST(SyntheticPath, NamesWhatIsWrong) {
  const auto error_of = [](const std::string& path) {
    const auto options = ParseSyntheticPath(path);
    return options ? std::string("no error") : options.error().message;
  };
  EXPECT_THAT(error_of("synthetic:kitchen"),
              HasSubstr("unknown scene \"kitchen\"; expected room or office"));
  EXPECT_THAT(error_of("synthetic:"), HasSubstr("unknown scene"));
  EXPECT_THAT(error_of("synthetic:room?frames=0"), HasSubstr("frames is \"0\""));
  EXPECT_THAT(error_of("synthetic:room?frames=ten"), HasSubstr("expected 1.."));
  EXPECT_THAT(error_of("synthetic:room?frames="), HasSubstr("frames"));
  EXPECT_THAT(error_of("synthetic:room?frames"), HasSubstr("frames"));
  EXPECT_THAT(error_of("synthetic:room?width=99999"), HasSubstr("width"));
  EXPECT_THAT(error_of("synthetic:room?noise=some"), HasSubstr("kinect or none"));
  EXPECT_THAT(error_of("synthetic:room?fps=3"), HasSubstr("unknown parameter \"fps\""));
  EXPECT_THAT(error_of("synthetic:room?rate=nan"), HasSubstr("rate"));
}

TEST(OpenSequence, OpensTheRoomLikeAnyDataset) {
  const auto opened = OpenSequence("synthetic:room?frames=6&width=64", "",
                                   {.stride = 2, .max_frames = 2, .camera_id = CameraId{9}});
  ASSERT_TRUE(opened) << opened.error().message;
  const Dataset& dataset = **opened;
  EXPECT_EQ(dataset.format(), "synthetic");
  ASSERT_EQ(dataset.size(), 2u);
  EXPECT_EQ(dataset.Header(1).frame_number, 3);
  EXPECT_EQ(dataset.Header(1).utime, 300000);
  const Result<SensorFrame> frame = dataset.Read(1);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header.camera_id, CameraId{9});
  EXPECT_EQ(frame->depth.width(), 64);
  EXPECT_EQ(frame->depth.height(), 48);
  EXPECT_TRUE(DecodeFrame(*frame));
  EXPECT_EQ(dataset.Read(1)->depth, frame->depth);
  EXPECT_EQ(dataset.Read(1)->color, frame->color);
}

TEST(OpenSequence, OpensTheOfficeWithItsDetections) {
  const std::string path = "synthetic:office?frames=10&width=96&noise=none";
  const auto dataset = OpenSequence(path, "", {.max_frames = 5});
  const auto source = OpenDetections(path);
  ASSERT_TRUE(dataset && source);
  EXPECT_EQ((*dataset)->name(), "office");
  ASSERT_EQ((*dataset)->size(), 5u);
  size_t found = 0;
  for (size_t i = 0; i < (*dataset)->size(); ++i) {
    EXPECT_TRUE(DecodeFrame(*(*dataset)->Read(i)));
    found += (*source)->ForFrame((*dataset)->Header(i))->detections.size();
  }
  EXPECT_GT(found, 10u);
}

TEST(OpenSequence, ItsDetectionsAreThoseOfItsFrames) {
  const auto dataset = OpenSequence("synthetic:room?frames=6&width=160&noise=none", "synthetic");
  ASSERT_TRUE(dataset) << dataset.error().message;
  const auto source = OpenDetections((*dataset)->default_detections_path().value());
  ASSERT_TRUE(source) << source.error().message;
  size_t found = 0;
  for (size_t i = 0; i < (*dataset)->size(); ++i) {
    const FrameHeader header = (*dataset)->Header(i);
    const Result<DetectionSet> set = (*source)->ForFrame(header);
    ASSERT_TRUE(set) << set.error().message;
    EXPECT_EQ(set->utime, header.utime);
    found += set->detections.size();
    for (const Detection& detection : set->detections) {
      EXPECT_EQ(detection.mask.image_width, header.camera.width);
    }
  }
  EXPECT_GT(found, 20u);
}

TEST(OpenSequence, DetectionsOfForeignFramesAreEmptyOrAnError) {
  const auto source = OpenDetections("synthetic:room?frames=6&width=160");
  ASSERT_TRUE(source);
  FrameHeader header;
  header.frame_number = 77;
  EXPECT_TRUE((*source)->ForFrame(header)->detections.empty());
  header.frame_number = 1;
  EXPECT_THAT((*source)->ForFrame(header).error().message, HasSubstr("camera"));
}

TEST(OpenSequence, ForwardsFoldersAndRefusesContradictions) {
  EXPECT_THAT(OpenSequence("/nowhere", "").error().message, HasSubstr("/nowhere"));
  EXPECT_THAT(OpenSequence("/nowhere", "synthetic").error().message,
              HasSubstr("synthetic:room or synthetic:office"));
  EXPECT_THAT(OpenSequence("synthetic:room", "tum").error().message, HasSubstr("\"tum\""));
  EXPECT_THAT(OpenSequence("synthetic:room", "", {.stride = 0}).error().message,
              HasSubstr("stride"));
  EXPECT_THAT(OpenSequence("synthetic:room", "", {.depth_unit_m = 0.01}).error().message,
              HasSubstr("depth unit"));
  EXPECT_THAT(OpenSequence("synthetic:hall", "").error().message, HasSubstr("hall"));
  EXPECT_THAT(OpenDetections("/nowhere.json").error().message, HasSubstr("/nowhere.json"));
  EXPECT_THAT(OpenDetections("synthetic:hall").error().message, HasSubstr("hall"));
}

TEST(SyntheticPath, ToursFollowEachOtherWithOtherErrors) {
  const auto once = OpenSequence("synthetic:room?frames=3&width=64", "");
  const auto twice = OpenSequence("synthetic:room?frames=3&width=64&tours=2", "");
  ASSERT_TRUE(once && twice);
  ASSERT_EQ((*twice)->size(), 6u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ((*twice)->Read(i)->depth, (*once)->Read(i)->depth);
    EXPECT_TRUE((*twice)->Header(i + 3).T_W_C.isApprox((*once)->Header(i).T_W_C, 0));
    EXPECT_GT((*twice)->Header(i + 3).utime, (*twice)->Header(2).utime);
    EXPECT_NE((*twice)->Read(i + 3)->depth, (*once)->Read(i)->depth);
  }
  EXPECT_FALSE(OpenSequence("synthetic:room?tours=0", ""));
}

}  // namespace
}  // namespace vismap
