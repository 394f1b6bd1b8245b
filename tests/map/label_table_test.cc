#include "map/label_table.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace vismap {
namespace {

constexpr SegmentLabel kA{1}, kB{2}, kC{3};

LabelTable ThreeLabels() {
  LabelTable table;
  table.GrowLabels(SegmentLabel{4});
  for (const SegmentLabel label : {kA, kB, kC}) {
    table.MutableRecord(label).frames = 10;
    table.MutableRecord(label).frames_with_detector = 10;
    table.MutableRecord(label).pixels = 1000 * Raw(label);
  }
  return table;
}

TEST(LabelTable, MergingConservesAllCounts) {
  LabelTable table = ThreeLabels();
  table.MutableRecord(kA).instance_evidence[InstanceId{1}] = 2;
  table.MutableRecord(kC).instance_evidence[InstanceId{1}] = 3;
  table.MutableRecord(kC).class_evidence[ClassId{62}] = 3;
  table.MutablePair(kB, kC).together = 2;
  table.MutablePair(kA, kB).together = 1;
  table.MutablePair(kA, kC).apart = 5;
  EXPECT_EQ(table.Merge(kC, kA), kA);
  EXPECT_EQ(table.Canonical(kC), kA);
  const LabelRecord& record = table.Record(kA);
  EXPECT_EQ(record.frames, 20u);
  EXPECT_EQ(record.pixels, 4000u);
  EXPECT_EQ(record.instance_evidence.at(InstanceId{1}), 5);
  EXPECT_EQ(record.class_evidence.at(ClassId{62}), 3);
  ASSERT_EQ(table.pairs().size(), 1u);
  EXPECT_EQ(table.MutablePair(kB, kA).together, 3);
  EXPECT_THROW(table.Record(kC), std::logic_error);
}

TEST(LabelTable, FollowsChainsOfMerges) {
  LabelTable table = ThreeLabels();
  table.Merge(kB, kC);
  table.Merge(kA, kB);
  EXPECT_EQ(table.Canonical(kC), kA);
  EXPECT_EQ(table.Alive(), std::vector<SegmentLabel>{kA});
}

TEST(LabelTable, ReadsOutTheInstanceWithMostEvidenceAndTheLowerOneOnTies) {
  LabelTable table = ThreeLabels();
  table.MutableRecord(kA).instance_evidence = {
      {InstanceId{4}, 3.F}, {InstanceId{2}, 3.F}, {InstanceId{9}, 1.F}};
  EXPECT_EQ(table.Read(kA).instance, InstanceId{2});
  EXPECT_EQ(table.Read(kB).instance, InstanceId::kNone);
}

TEST(LabelTable, EvidenceInATenthOfTheFramesThatADetectorSawIsTooLittle) {
  LabelTable table = ThreeLabels();
  table.MutableRecord(kA).instance_evidence[InstanceId{1}] = 0.9F;
  EXPECT_EQ(table.Read(kA).instance, InstanceId::kNone);
  table.MutableRecord(kA).frames = 1000;  // frames without detector do not count
  table.MutableRecord(kA).instance_evidence[InstanceId{1}] = 1.0F;
  EXPECT_EQ(table.Read(kA).instance, InstanceId{1});
}

TEST(LabelTable, ClassOfAnInstanceIsDecidedByItsLargePieces) {
  LabelTable table = ThreeLabels();
  for (const SegmentLabel label : {kA, kB, kC})
    table.MutableRecord(label).instance_evidence[InstanceId{1}] = 5;
  table.MutableRecord(kA).class_evidence[ClassId{1}] = 2;  // 100 pixels a frame
  table.MutableRecord(kC).class_evidence[ClassId{2}] = 1;  // 300 pixels a frame
  EXPECT_EQ(table.InstanceClasses().at(InstanceId{1}), ClassId{2});
}

}  // namespace
}  // namespace vismap
