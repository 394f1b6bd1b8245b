#include "datasets/detections_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "codecs/mask_codec.h"
#include "sample_images.h"
#include "support/mutations.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

FrameHeader Header(int64_t number, int width = 3, int height = 2) {
  return {.utime = 77,
          .camera_id = CameraId{5},
          .frame_number = number,
          .camera = {width, height, 10, 10, 1, 1}};
}

std::string Entry(const std::string& counts, const std::string& rest = "") {
  return R"({"image_id": 4, "category_id": 62, "score": 0.5, "bbox": [0,0,1,1], "segmentation":)"
         R"( {"size": [2, 3], "counts": )" +
         counts + "}" + rest + "}";
}

TEST(CocoResults, ReadsBothKindsOfCounts) {
  const TempFolder folder;
  folder.Write("d.json", "[" + Entry("[0, 2, 1, 1, 2]") + "," + Entry("\"021O1\"") + "]");
  const auto source = LoadCocoResults((folder / "d.json").string());
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->size(), 2);
  const Result<DetectionSet> set = (*source)->ForFrame(Header(4));
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_EQ(set->utime, 77);
  EXPECT_EQ(set->camera_id, CameraId{5});
  EXPECT_EQ(set->frame_number, 4);
  ASSERT_EQ(set->detections.size(), 2u);
  EXPECT_EQ(set->detections[0].class_id, ClassId{62});
  EXPECT_EQ(set->detections[0].score, 0.5f);
  EXPECT_EQ(EncodeMask(set->detections[0].mask), (MaskRuns{0, 2, 1, 1, 2}));
  EXPECT_EQ(set->detections[0].mask, set->detections[1].mask);
}

TEST(CocoResults, WhatIsWrittenIsReadBack) {
  Mask mask{3, 2, 1, 0, Image<uint8_t>(2, 2, 1)};
  mask.inside(1, 0) = 0;
  DetectionSet first{77, CameraId{5}, 4, {{ClassId{62}, 0.1f, mask}, {ClassId{900}, 1.0f, mask}}};
  const DetectionSet none{78, CameraId{5}, 5, {}}, last{79, CameraId{5}, 6, {first.detections[0]}};
  const TempFolder folder;
  const std::string path = (folder / "d.json").string();
  const std::vector<DetectionSet> sets = {first, none, last};
  const auto written = WriteCocoResults(path, sets);
  ASSERT_TRUE(written) << written.error().message;
  const auto source = LoadCocoResults(path);
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->size(), 3);
  for (const DetectionSet& set : sets) {
    const Result<DetectionSet> read = (*source)->ForFrame(Header(set.frame_number));
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->detections.size(), set.detections.size());
    for (size_t i = 0; i < set.detections.size(); ++i) {
      EXPECT_EQ(read->detections[i].class_id, set.detections[i].class_id);
      EXPECT_EQ(read->detections[i].score, set.detections[i].score);
      EXPECT_EQ(read->detections[i].mask, set.detections[i].mask);
    }
  }
  first.frame_number = -1;
  EXPECT_FALSE(WriteCocoResults(path, std::vector{first})) << "no frame_number";
}

TEST(CocoResults, AFrameWithoutEntriesHasNoDetections) {
  const TempFolder folder;
  folder.Write("d.json", "[" + Entry("[6]") + "]");
  const auto source = LoadCocoResults((folder / "d.json").string());
  ASSERT_TRUE(source);
  EXPECT_TRUE((*source)->ForFrame(Header(3))->detections.empty());
  EXPECT_EQ((*source)->ForFrame(Header(4))->detections.size(), 1u);
}

TEST(CocoResults, MasksOfAnotherSizeThanTheFrameAreAnError) {
  const TempFolder folder;
  folder.Write("d.json", "[" + Entry("[6]") + "]");
  const auto source = LoadCocoResults((folder / "d.json").string());
  ASSERT_TRUE(source);
  EXPECT_THAT((*source)->ForFrame(Header(4, 640, 480)).error().message,
              AllOf(HasSubstr("image 4"), HasSubstr("3x2"), HasSubstr("640x480")));
}

TEST(CocoResults, NamesFileEntryAndField) {
  const TempFolder folder;
  const auto error_of = [&](const std::string& text) {
    folder.Write("d.json", text);
    const auto source = LoadCocoResults((folder / "d.json").string());
    return source ? std::string("no error") : source.error().message;
  };
  const auto entry_error = [&](const std::string& entry) {
    return error_of("[" + Entry("[6]") + "," + entry + "]");
  };
  EXPECT_THAT(error_of("{}"), AllOf(HasSubstr("d.json"), HasSubstr("array")));
  EXPECT_THAT(error_of("[{]"), HasSubstr("not JSON"));
  EXPECT_THAT(error_of(""), HasSubstr("not JSON"));
  EXPECT_THAT(entry_error("5"), HasSubstr("d.json: entry 1: expected an object"));
  EXPECT_THAT(entry_error("{}"), HasSubstr("image_id"));
  EXPECT_THAT(entry_error(R"({"image_id": "a"})"), HasSubstr("image_id"));
  EXPECT_THAT(entry_error(R"({"image_id": -1})"), HasSubstr("image_id is -1"));
  EXPECT_THAT(entry_error(R"({"image_id": 18446744073709551615})"), HasSubstr("image_id is"));
  EXPECT_THAT(entry_error(R"({"image_id": 1})"), HasSubstr("category_id"));
  EXPECT_THAT(entry_error(R"({"image_id": 1, "category_id": 0})"), HasSubstr("category_id is 0"));
  EXPECT_THAT(entry_error(R"({"image_id": 1, "category_id": 70000})"), HasSubstr("70000"));
  EXPECT_THAT(entry_error(R"({"image_id": 1, "category_id": 1})"), HasSubstr("score"));
  EXPECT_THAT(entry_error(R"({"image_id": 1, "category_id": 1, "score": 1.5})"),
              HasSubstr("score is 1.5"));
  EXPECT_THAT(entry_error(R"({"image_id": 1, "category_id": 1, "score": 1})"),
              HasSubstr("segmentation"));
  EXPECT_THAT(entry_error(Entry("[5]")), HasSubstr("add up to 5; expected 3x2 = 6"));
  EXPECT_THAT(entry_error(Entry("[-1, 7]")), HasSubstr("run lengths"));
  EXPECT_THAT(entry_error(Entry("[1.5]")), HasSubstr("run lengths"));
  EXPECT_THAT(entry_error(Entry("\"~\"")), HasSubstr("character 0"));
  EXPECT_THAT(entry_error(Entry("{}")), HasSubstr("counts"));
  EXPECT_THAT(LoadCocoResults("/nowhere/d.json").error().message, HasSubstr("/nowhere/d.json"));
}

TEST(CocoResults, MutationsGiveDetectionsOrAnErrorThatNamesTheFile) {
  const TempFolder folder;
  const std::string good = "[" + Entry("[0, 2, 1, 1, 2]") + "," + Entry("\"021O1\"") + "]";
  ForEachMutation(std::vector<uint8_t>(good.begin(), good.end()), 3000,
                  [&](const std::vector<uint8_t>& bytes) {
                    folder.Write("d.json", bytes);
                    const auto source = LoadCocoResults((folder / "d.json").string());
                    EXPECT_THAT(source ? "d.json" : source.error().message, HasSubstr("d.json"));
                    if (source) (void)(*source)->ForFrame(Header(4));
                  });
}

std::vector<uint8_t> IdsPng(const std::vector<uint16_t>& ids, int width, int height) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", cv::Mat(height, width, CV_16UC1, const_cast<uint16_t*>(ids.data())), bytes);
  return bytes;
}

TEST(InstancePngs, ReadsIdsThroughACsvTable) {
  const TempFolder folder;
  folder.Write("mask_image00004.png", IdsPng({0, 7, 7, 300, 7, 9}, 3, 2));
  folder.Write("instances.csv", "id,category_id,score\n300,62,0.75\n7,44,0.5\n9,0,1\n");
  const auto source = LoadDetections(folder.path().string());
  ASSERT_TRUE(source) << source.error().message;
  const Result<DetectionSet> set = (*source)->ForFrame(Header(4));
  ASSERT_TRUE(set) << set.error().message;
  ASSERT_EQ(set->detections.size(), 2u);  // in order of their ids; 9 is not a detection
  EXPECT_EQ(set->detections[0].class_id, ClassId{44});
  EXPECT_EQ(set->detections[0].score, 0.5f);
  EXPECT_EQ(EncodeMask(set->detections[0].mask), (MaskRuns{2, 3, 1}));
  EXPECT_EQ(set->detections[1].class_id, ClassId{62});
  EXPECT_TRUE((*source)->ForFrame(Header(5))->detections.empty());
}

TEST(InstancePngs, ATableMayHoldRowsForOneFrame) {
  const TempFolder folder;
  folder.Write("1.png", IdsPng({1, 0}, 2, 1));
  folder.Write("2.png", IdsPng({1, 0}, 2, 1));
  folder.Write("instances.json", R"([{"id": 1, "category_id": 10, "score": 0.25},
                                     {"id": 1, "category_id": 20, "image_id": 2}])");
  const auto source = LoadInstancePngs(folder.path().string());
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->ForFrame(Header(1, 2, 1))->detections[0].class_id, ClassId{10});
  EXPECT_EQ((*source)->ForFrame(Header(2, 2, 1))->detections[0].class_id, ClassId{20});
  EXPECT_EQ((*source)->ForFrame(Header(2, 2, 1))->detections[0].score, 1.0f);
}

TEST(InstancePngs, NamesWhatIsWrong) {
  const TempFolder folder;
  folder.Write("4.png", IdsPng({0, 7, 7, 300, 7, 9}, 3, 2));
  const auto error_of = [&](const std::string& table) {
    folder.Write("instances.csv", table);
    const auto source = LoadInstancePngs(folder.path().string());
    if (!source) return source.error().message;
    const auto set = (*source)->ForFrame(Header(4));
    return set ? std::string("no error") : set.error().message;
  };
  EXPECT_THAT(error_of("id,category_id\n7,1\n9,1\n"),
              AllOf(HasSubstr("4.png"), HasSubstr("instance 300 is not in")));
  EXPECT_THAT(error_of("id,category_id\n7\n"), HasSubstr("line 2: expected 2 columns"));
  EXPECT_THAT(error_of("id,category_id\n7,chair\n"), HasSubstr("line 2: expected only numbers"));
  EXPECT_THAT(error_of("id,category_id\n0,1\n"), HasSubstr("1..65535"));
  EXPECT_THAT(error_of("id,category_id\n7,-1\n"), HasSubstr("category_id"));
  EXPECT_THAT(error_of("id,category_id,score\n7,1,2\n"), HasSubstr("score"));
  EXPECT_THAT(error_of("id,category_id\n7,1\n7,2\n"), HasSubstr("second row for id 7"));
  EXPECT_THAT(error_of("nonsense\n1\n"), HasSubstr("id"));
  folder.Write("5.png", GreyPng(3, 2, 1, 8));
  folder.Write("instances.csv", "id,category_id\n7,1\n");
  const auto source = LoadInstancePngs(folder.path().string());
  ASSERT_TRUE(source);
  EXPECT_THAT((*source)->ForFrame(Header(5)).error().message, HasSubstr("16-bit"));
  EXPECT_THAT((*source)->ForFrame(Header(4, 4, 2)).error().message, HasSubstr("3x2; expected 4x2"));
  folder.Write("4b4.png", "");
  EXPECT_THAT(LoadInstancePngs(folder.path().string()).error().message,
              HasSubstr("two PNGs have number 4"));
  const TempFolder empty;
  EXPECT_THAT(LoadInstancePngs(empty.path().string()).error().message, HasSubstr("no PNGs"));
}

}  // namespace
}  // namespace vismap
