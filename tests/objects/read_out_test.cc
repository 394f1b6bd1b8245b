#include "objects/read_out.h"

#include <gmock/gmock.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;

constexpr InstanceId kThing{3};
constexpr ClassId kPlant{64};

/// How often a label was observed with a detector, and its evidence for the instance kThing.
struct Observed {
  uint32_t frames = 0;
  float evidence = 0;
};
/// A table with these labels.
LabelTable TableOf(const std::vector<Observed>& labels) {
  LabelTable table;
  table.GrowInstances(InstanceId{Raw(kThing) + 1});
  table.GrowLabels(static_cast<SegmentLabel>(labels.size() + 1));
  for (size_t i = 0; i < labels.size(); ++i) {
    LabelRecord& record = table.MutableRecord(static_cast<SegmentLabel>(i + 1));
    record.frames = record.frames_with_detector = labels[i].frames;
    record.instance_evidence[kThing] = labels[i].evidence;
    record.class_evidence[kPlant] = labels[i].evidence;
  }
  return table;
}

bool IsNamed(const std::vector<Observed>& labels) {
  const LabelReadOut read_out = ReadLabels(TableOf(labels));
  const bool named = read_out.instances.contains(kThing);
  for (size_t l = 1; l <= labels.size(); ++l) {
    EXPECT_TRUE(named || read_out.labels[l].instance == InstanceId::kNone);
  }
  return named;
}

TEST(ReadLabels, OneDetectionAmongManyFramesNamesNothing) {
  EXPECT_TRUE(IsNamed({{1, 0.4F}}));
  EXPECT_TRUE(IsNamed({{3, 0.8F}})) << "a quarter of the frames";
  EXPECT_FALSE(IsNamed({{4, 0.8F}}));
  EXPECT_FALSE(IsNamed({{8, 0.8F}}));
  EXPECT_TRUE(IsNamed({{8, 1.2F}})) << "two detections, at least";
  EXPECT_TRUE(IsNamed({{3, 0.9F}})) << "a detector that is never sure, but always says so";
}

TEST(ReadLabels, OneConfirmedLabelIsEnoughForAnInstance) {
  EXPECT_FALSE(IsNamed({{5, 0.6F}, {5, 0.6F}}));
  EXPECT_TRUE(IsNamed({{5, 0.6F}, {10, 4.0F}}));
  const LabelReadOut read_out = ReadLabels(TableOf({{5, 0.6F}, {10, 4.0F}, {9, 0.01F}}));
  EXPECT_THAT(read_out.instances.at(kThing).labels, ElementsAre(SegmentLabel{1}, SegmentLabel{2}));
  EXPECT_EQ(read_out.instances.at(kThing).class_id, kPlant);
}

TEST(ShowLabels, ShowsWhatIsReadOut) {
  EXPECT_EQ(ShowLabels(TableOf({{8, 0.8F}}))[1], (ShownLabel{.segment = SegmentLabel{1}}));
  EXPECT_EQ(ShowLabels(TableOf({{8, 4.0F}}))[1], (ShownLabel{SegmentLabel{1}, kThing, kPlant}));
}

}  // namespace
}  // namespace vismap
