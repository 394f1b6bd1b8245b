#include "evaluation/ranked_ap.h"

#include <gtest/gtest.h>

#include "evaluation/matches_by_hand.h"

namespace vismap {
namespace {

const EvaluatedClass kChairs{"chair", kChair};

TEST(RankedAp, PerfectIsOne) {
  MatchesByHand matches;
  matches.Perfect(kChair, 100);
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, kChairs, {}).ap.value(), 1);
}

TEST(RankedAp, WhatLiesOnVoidIsFalse) {
  MatchesByHand matches;
  matches.Perfect(kChair, 100);
  matches.Prediction(kChair, 200, {});  // larger, hence ranked first without scores
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, kChairs, 0.5, {}).value(), 0.5);
  RankedApOptions options;
  options.scores = {{InstanceId{1}, 0.9}, {InstanceId{2}, 0.8}};
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, kChairs, 0.5, options).value(), 1);
}

TEST(RankedAp, PrecisionIsTheBestAtThisRecallOrBeyond) {
  MatchesByHand matches;
  matches.Prediction(kChair, 50, {});
  matches.Perfect(kChair, 100);
  matches.Perfect(kChair, 100);
  RankedApOptions options;
  options.scores = {{InstanceId{1}, 0.9}, {InstanceId{2}, 0.8}, {InstanceId{3}, 0.7}};
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, kChairs, 0.5, options).value(), 2.0 / 3);
}

TEST(RankedAp, SecondPieceOfAnObjectIsFalse) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 100);
  matches.Prediction(kChair, 60, {{chair, 60}});
  matches.Prediction(kChair, 40, {{chair, 40}});
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, kChairs, 0.3, {}).value(), 1);  // found before it
  EXPECT_EQ(ScoreRanked(matches, kChairs, 0.6, {}), 0);                 // 0.6 is not above 0.6
}

TEST(RankedAp, AliasesCountSmallThingsDoNot) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 60);
  matches.Truth(kChair, 59);
  matches.Prediction(kTable, 60, {{chair, 60}});
  matches.Prediction(kChair, 9, {});
  EXPECT_EQ(ScoreRanked(matches, kChairs, 0.5, {}), 0);
  EXPECT_DOUBLE_EQ(ScoreRanked(matches, {"seat", kChair, {kTable}}, 0.5, {}).value(), 1);
}

}  // namespace
}  // namespace vismap
