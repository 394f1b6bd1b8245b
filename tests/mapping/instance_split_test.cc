#include "mapping/instance_split.h"

#include <gmock/gmock.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr SegmentLabel kSeat{1}, kBack{2}, kOtherSeat{3}, kOtherBack{4}, kWheel{5};
constexpr InstanceId kGlued{1};
constexpr DetectionIndex kMaskA{0}, kMaskB{1};

/// Five labels of one instance.
LabelTable GluedChairs() {
  LabelTable table;
  table.GrowLabels(SegmentLabel{6});
  table.GrowInstances(InstanceId{2});
  for (const SegmentLabel label : table.Alive()) {
    LabelRecord& record = table.MutableRecord(label);
    record.frames = record.frames_with_detector = 20;
    record.pixels = 20'000;
    record.instance_evidence[kGlued] = 20;
  }
  table.MutableRecord(kBack).pixels = 40'000;
  return table;
}

const std::vector<MaskedLabel> kOneMask{{kSeat, kMaskA, 1.F},
                                        {kBack, kMaskA, 1.F},
                                        {kOtherSeat, kMaskA, 1.F},
                                        {kOtherBack, kMaskA, 1.F}};
const std::vector<MaskedLabel> kTwoMasks{{kSeat, kMaskA, 1.F},
                                         {kBack, kMaskA, 1.F},
                                         {kOtherSeat, kMaskB, 1.F},
                                         {kOtherBack, kMaskB, 1.F}};

TEST(MaskBonds, HoldLabelsOfOneMaskAndAreLoosenedByTwo) {
  MaskBonds bonds;
  bonds.AddFrame(kTwoMasks);
  EXPECT_EQ(bonds.Between(kBack, kSeat), 1);
  EXPECT_EQ(bonds.Between(kSeat, kOtherSeat), 0) << "never were one";
  bonds.AddFrame(kOneMask);
  EXPECT_EQ(bonds.Between(kSeat, kOtherSeat), 1);
  bonds.AddFrame(kTwoMasks);
  bonds.AddFrame(kTwoMasks);
  EXPECT_EQ(bonds.Between(kSeat, kOtherSeat), -1);
}

TEST(MaskBonds, AreNotBeyondRepairAfterAnyNumberOfFrames) {
  MaskBonds bonds;
  for (int i = 0; i < 1000; ++i) bonds.AddFrame(kOneMask);
  for (int i = 0; i < 8; ++i) bonds.AddFrame(kTwoMasks);
  EXPECT_LT(bonds.Between(kSeat, kOtherSeat), 0);
  EXPECT_EQ(bonds.Between(kSeat, kBack), MaskBonds::kMost);
}

TEST(MaskBonds, OfAMergedLabelGoToTheSurvivor) {
  MaskBonds bonds;
  bonds.AddFrame(kOneMask);
  bonds.AddFrame(kTwoMasks);
  bonds.Merge(kBack, kSeat);
  EXPECT_EQ(bonds.Between(kSeat, kOtherSeat), 0);
  EXPECT_EQ(bonds.Between(kOtherSeat, kOtherBack), 2);
  for (const auto& [pair, bond] : bonds.pairs())
    EXPECT_TRUE(pair.first != kBack && pair.second != kBack);
}

TEST(SplitInstances, GivesWhatMasksKeepApartAnIdOfItsOwnWithItsEvidence) {
  LabelTable table = GluedChairs();
  for (int i = 0; i < 30; ++i) EXPECT_THAT(SplitInstances(kOneMask, 2, &table), IsEmpty());
  int frames = 0;
  std::vector<InstanceSplit> splits;
  while (splits.empty() && frames < 20) {
    splits = SplitInstances(kTwoMasks, 2, &table);
    ++frames;
  }
  EXPECT_EQ(frames, 6);
  EXPECT_THAT(splits, ElementsAre(InstanceSplit{kGlued, InstanceId{2}}));
  EXPECT_EQ(table.Read(kSeat).instance, kGlued) << "more of it is here";
  EXPECT_EQ(table.Read(kBack).instance, kGlued);
  EXPECT_EQ(table.Read(kOtherSeat).instance, InstanceId{2});
  EXPECT_EQ(table.Read(kOtherBack).instance, InstanceId{2});
  EXPECT_EQ(table.Read(kWheel).instance, kGlued) << "no mask said whose it is";
  EXPECT_EQ(table.Record(kOtherSeat).instance_evidence.at(InstanceId{2}), 20);
  EXPECT_EQ(table.next_instance(), InstanceId{3});
  EXPECT_THAT(SplitInstances(kTwoMasks, 2, &table), IsEmpty());
}

/// One label of each object, under masks of their own.
std::vector<MaskedLabel> Pair(SegmentLabel one, SegmentLabel other) {
  return {{one, kMaskA, 1.F}, {other, kMaskB, 1.F}};
}

TEST(SplitInstances, BondsOfAllLabelsCountTogetherWhenNoneIsLowEnough) {
  LabelTable table = GluedChairs();
  SplitInstances(kOneMask, 2, &table);
  const std::vector<std::vector<MaskedLabel>> frames{
      Pair(kSeat, kOtherBack), Pair(kSeat, kOtherBack), Pair(kBack, kOtherSeat),
      Pair(kBack, kOtherSeat), Pair(kSeat, kOtherSeat)};
  for (const auto& frame : frames) EXPECT_THAT(SplitInstances(frame, 2, &table), IsEmpty());
  EXPECT_THAT(SplitInstances(Pair(kBack, kOtherBack), 2, &table),
              ElementsAre(InstanceSplit{kGlued, InstanceId{2}}));
  EXPECT_EQ(table.bonds().Between(kSeat, kOtherBack), -1) << "the lowest bond";
  EXPECT_EQ(table.Read(kBack).instance, kGlued);
  EXPECT_EQ(table.Read(kOtherSeat).instance, InstanceId{2});
  EXPECT_EQ(table.Read(kOtherBack).instance, InstanceId{2});
}

TEST(SplitInstances, ManySlightlyLooseBondsDoNotSplit) {
  LabelTable table = GluedChairs();
  SplitInstances(kOneMask, 2, &table);
  std::vector<MaskedLabel> loosening = kTwoMasks;
  for (MaskedLabel& label : loosening) label.evidence = 0.6F;
  for (int i = 0; i < 3; ++i) EXPECT_THAT(SplitInstances(loosening, 2, &table), IsEmpty());
  EXPECT_LT(4 * table.bonds().Between(kSeat, kOtherSeat), -2) << "though together they are low";
}

TEST(SplitInstances, TakesTheIdThatMasksHaveGivenAlreadyUnlessItIsAnothers) {
  for (const bool taken : {false, true}) {
    LabelTable table = GluedChairs();
    table.GrowInstances(InstanceId{4});
    table.MutableRecord(kOtherSeat).instance_evidence[InstanceId{3}] = 2;
    if (taken) table.MutableRecord(kWheel).instance_evidence = {{InstanceId{3}, 20.F}};
    SplitInstances(kOneMask, 2, &table);
    for (int i = 0; i < 3; ++i) SplitInstances(kTwoMasks, 2, &table);
    EXPECT_EQ(table.Read(kOtherSeat).instance, taken ? InstanceId{4} : InstanceId{3});
  }
}

TEST(SplitInstances, AMissingMaskAndAnotherObjectsMaskSayNothing) {
  LabelTable table = GluedChairs();
  SplitInstances(kOneMask, 2, &table);
  const std::vector<MaskedLabel> half{{kSeat, kMaskA, 1.F}, {kBack, kMaskA, 1.F}};
  for (int i = 0; i < 50; ++i) EXPECT_THAT(SplitInstances(half, 2, &table), IsEmpty());
  EXPECT_EQ(table.Read(kOtherSeat).instance, kGlued);
}

}  // namespace
}  // namespace vismap
