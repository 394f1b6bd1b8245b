#include "evaluation/scannet_ap.h"

#include <gtest/gtest.h>

#include "evaluation/matches_by_hand.h"

namespace vismap {
namespace {

double Ap(const InstanceMatches& matches, double overlap, const ScanNetOptions& options = {}) {
  return IntegrateScanNet(CollectScanNetEvidence(matches, kChair, overlap, options)).value_or(-1);
}

ScanNetOptions Confidences(const std::vector<double>& confidences) {
  ScanNetOptions options;
  options.confidence.emplace();
  for (size_t i = 0; i < confidences.size(); ++i)
    (*options.confidence)[InstanceId{static_cast<uint32_t>(i + 1)}] = confidences[i];
  return options;
}

TEST(ScanNetAp, PerfectIsOneAtEveryOverlap) {
  MatchesByHand matches;
  matches.Perfect(kChair, 500);
  const ScanNetAp score = ScoreScanNet(matches, kChair, {});
  EXPECT_DOUBLE_EQ(score.ap25.value(), 1);
  EXPECT_DOUBLE_EQ(score.ap50.value(), 1);
  EXPECT_DOUBLE_EQ(score.ap.value(), 1);
}

TEST(ScanNetAp, ClassWithoutObjectsHasNoneAndWithoutPredictionsZero) {
  MatchesByHand matches;
  EXPECT_FALSE(ScoreScanNet(matches, kChair, {}).ap);
  const size_t chair = matches.Truth(kChair, 500);
  matches.Prediction(kTable, 500, {{chair, 500}});  // of another class: ignored
  EXPECT_EQ(ScoreScanNet(matches, kChair, {}).ap, 0);
}

// As 87.5 in the paper's Table I: 3 of 3 objects, 4 predictions.
TEST(ScanNetAp, WithEqualConfidencesIsRecallTimesTheMeanOfOneAndPrecision) {
  MatchesByHand matches;
  for (int i = 0; i < 3; ++i) matches.Perfect(kChair, 200);
  const size_t table = matches.Truth(kTable, 300);
  matches.Prediction(kChair, 200, {{table, 200}});
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5), 0.875);
}

TEST(ScanNetAp, OverlapMustExceedTheThreshold) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 400);
  matches.Prediction(kChair, 200, {{chair, 200}});
  EXPECT_EQ(Ap(matches, 0.5), 0);
  EXPECT_DOUBLE_EQ(Ap(matches, 0.45), 1);
}

TEST(ScanNetAp, ApIsTheMeanOverNineOverlaps) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 200);
  matches.Prediction(kChair, 144, {{chair, 144}});  // IoU 0.72: matches at 0.5 to 0.7
  const ScanNetAp score = ScoreScanNet(matches, kChair, {});
  EXPECT_DOUBLE_EQ(score.ap50.value(), 1);
  EXPECT_DOUBLE_EQ(score.ap.value(), 5.0 / 9);
}

// Two halves of a chair.
TEST(ScanNetAp, SplitObjectHasOneMatchAndTheLowerConfidenceIsFalse) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 400);
  for (int half = 0; half < 2; ++half) matches.Prediction(kChair, 200, {{chair, 200}});
  EXPECT_EQ(Ap(matches, 0.5), 0);
  EXPECT_EQ(CollectScanNetEvidence(matches, kChair, 0.5, {}).false_positives(), 2);
  EXPECT_DOUBLE_EQ(Ap(matches, 0.25), 0.75);                          // r = 1, p = 1/2
  EXPECT_DOUBLE_EQ(Ap(matches, 0.25, Confidences({0.4, 0.9})), 1.0);  // the match has 0.9
}

// One prediction over two chairs.
TEST(ScanNetAp, MergedObjectsHaveOneMatchAtMost) {
  MatchesByHand matches;
  const size_t a = matches.Truth(kChair, 200), b = matches.Truth(kChair, 200);
  matches.Prediction(kChair, 400, {{a, 200}, {b, 200}});
  EXPECT_EQ(Ap(matches, 0.5), 0);
  const ScanNetEvidence evidence = CollectScanNetEvidence(matches, kChair, 0.25, {});
  EXPECT_EQ(evidence.true_positives(), 1);
  EXPECT_EQ(evidence.false_positives(), 0);
  EXPECT_EQ(evidence.hard_false_negatives, 1);
  EXPECT_DOUBLE_EQ(Ap(matches, 0.25), 0.5);
}

TEST(ScanNetAp, PredictionMoreOnVoidThanTheOverlapIsIgnored) {
  MatchesByHand matches;
  matches.Perfect(kChair, 500);
  const size_t table = matches.Truth(kTable, 500);
  matches.Prediction(kChair, 200, {{table, 80}});  // 120 on void
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5), 1);
  EXPECT_DOUBLE_EQ(Ap(matches, 0.6), 0.75);  // a share of 0.6 is not more than 0.6
}

TEST(ScanNetAp, SmallPredictionsAreSkipped) {
  MatchesByHand matches;
  const size_t chair = matches.Truth(kChair, 100);
  matches.Prediction(kChair, 99, {{chair, 99}});
  EXPECT_EQ(Ap(matches, 0.5), 0);
  EXPECT_EQ(CollectScanNetEvidence(matches, kChair, 0.5, {}).predictions, 0);
}

TEST(ScanNetAp, SmallObjectsAreVoid) {
  MatchesByHand matches;
  const size_t small = matches.Truth(kChair, 99);
  EXPECT_EQ(Ap(matches, 0.5), -1);
  matches.Perfect(kChair, 500);
  const size_t table = matches.Truth(kTable, 500);
  matches.Prediction(kChair, 130, {{small, 90}, {table, 40}});   // IoU 0.65 with the small one
  matches.Prediction(kChair, 300, {{small, 99}, {table, 141}});  // 99 + 60 of 300 are ignored
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5), 1);
}

TEST(ScanNetAp, EqualConfidencesAreOnePointOfTheCurve) {
  MatchesByHand matches;
  matches.Perfect(kChair, 200);
  matches.Perfect(kChair, 200);
  const size_t table = matches.Truth(kTable, 300);
  matches.Prediction(kChair, 200, {{table, 200}});
  // points (r, p): (0, 1), (1/2, 1/2), (1, 2/3)
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5, Confidences({0.8, 0.5, 0.8})),
                   1 * 0.25 + 0.5 * 0.5 + 2.0 / 3 * 0.25);
  // points (r, p): (0, 1), (0, 0), (1/2, 1/2), (1, 2/3)
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5, Confidences({0.8, 0.5, 0.9})), 0.5 * 0.5 + 2.0 / 3 * 0.25);
}

TEST(ScanNetAp, InstanceWithoutConfidenceComesLast) {
  MatchesByHand matches;
  matches.Perfect(kChair, 200);
  const size_t table = matches.Truth(kTable, 300);
  matches.Prediction(kChair, 200, {{table, 200}});
  EXPECT_DOUBLE_EQ(Ap(matches, 0.5, Confidences({0.1})), 1);
}

}  // namespace
}  // namespace vismap
