#include "evaluation/panoptic.h"

#include <gtest/gtest.h>

#include "evaluation/matches_by_hand.h"

namespace vismap {
namespace {

TEST(PanopticQuality, IsTheIouOfMatchesTimesTheirF1) {
  MatchesByHand matches;
  const size_t found = matches.Truth(kChair, 100);
  matches.Truth(kChair, 100);  // missed
  const size_t table = matches.Truth(kTable, 200);
  matches.Prediction(kChair, 80, {{found, 80}});
  matches.Prediction(kChair, 100, {{table, 100}});
  const PanopticScore score = ScorePanoptic(matches, kChair, 60);
  EXPECT_EQ(score.true_positives, 1);
  EXPECT_EQ(score.false_positives, 1);
  EXPECT_EQ(score.false_negatives, 1);
  EXPECT_DOUBLE_EQ(score.sq().value(), 0.8);
  EXPECT_DOUBLE_EQ(score.rq().value(), 0.5);
  EXPECT_DOUBLE_EQ(score.pq().value(), 0.4);
}

TEST(PanopticQuality, VoidNeitherWidensAPredictionNorMakesItFalse) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 100), small = matches.Truth(kChair, 59);
  matches.Prediction(kChair, 300, {{chair, 90}, {small, 10}});  // 200 on void
  matches.Prediction(kChair, 100, {{small, 59}});
  const PanopticScore score = ScorePanoptic(matches, kChair, 60);
  EXPECT_DOUBLE_EQ(score.sum_iou, 0.9);
  EXPECT_EQ(score.false_positives, 0);
  EXPECT_EQ(score.false_negatives, 0);
}

TEST(PanopticQuality, NothingThereIsNothingToMeasure) {
  EXPECT_FALSE(ScorePanoptic({}, kChair, 60).pq());
  MatchesByHand matches;
  matches.Truth(kChair, 100);
  EXPECT_EQ(ScorePanoptic(matches, kChair, 60).pq(), 0);
}

}  // namespace
}  // namespace vismap
