// Parameters that make a computed sequence harder: worse detectors, poses and sensors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "simulation/sequence.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

const std::string kRoom = "synthetic:room?width=160";

struct Sequence {
  std::unique_ptr<Dataset> dataset;
  std::unique_ptr<DetectionSource> detections;

  FrameHeader Header(size_t i) const { return dataset->Header(i); }
  DetectionSet DetectionsOf(size_t i) const { return *detections->ForFrame(Header(i)); }
};

Sequence Open(const std::string& parameters) {
  Result<std::unique_ptr<Dataset>> dataset = OpenSequence(kRoom + parameters, "");
  EXPECT_TRUE(dataset) << dataset.error().message;
  auto detections = OpenDetections((*dataset)->default_detections_path().value());
  EXPECT_TRUE(detections) << detections.error().message;
  return {std::move(*dataset), std::move(*detections)};
}

bool SameDetections(const DetectionSet& a, const DetectionSet& b) {
  return std::equal(a.detections.begin(), a.detections.end(), b.detections.begin(),
                    b.detections.end(), [](const Detection& x, const Detection& y) {
                      return x.class_id == y.class_id && x.score == y.score && x.mask == y.mask;
                    });
}

bool SameSequence(const Sequence& a, const Sequence& b) {
  for (size_t i = 0; i < 3; ++i) {
    if (a.Header(i).T_W_C.matrix() != b.Header(i).T_W_C.matrix()) return false;
    if (a.dataset->Read(i)->depth != b.dataset->Read(i)->depth) return false;
    if (!SameDetections(a.DetectionsOf(i), b.DetectionsOf(i))) return false;
  }
  return true;
}

TEST(Disturbances, ByDefaultAreThoseOfBefore) {
  const Sequence plain = Open("&frames=8");
  EXPECT_TRUE(SameSequence(plain, Open("&frames=8&detection_rate=0.9&class_confusion=0&mask_noise=2"
                                       "&detect_every=1&pose_noise=0&depth_noise=1")));
  // The values from before these parameters existed.
  const std::vector<size_t> expected{5, 7, 9};
  for (size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(plain.DetectionsOf(i).detections.size(), expected[i]) << i;
  EXPECT_EQ(plain.Header(2).T_W_C.matrix(), MakeHeaders({.frames = 8})[2].T_W_C.matrix());
}

TEST(Disturbances, DependOnTheSeedAlone) {
  const std::string worse =
      "&frames=8&detection_rate=0.7&class_confusion=0.2&mask_noise=6&pose_noise=0.01&depth_noise=2";
  EXPECT_TRUE(SameSequence(Open(worse), Open(worse)));
  EXPECT_FALSE(SameSequence(Open(worse), Open(worse + "&seed=2")));
}

TEST(Disturbances, RefuseWhatIsOutOfBounds) {
  const auto error_of = [](const std::string& parameter) {
    const auto options = ParseSyntheticPath("synthetic:office?" + parameter);
    return options ? std::string("no error") : options.error().message;
  };
  for (const char* wrong : {"detection_rate=1.1", "detection_rate=-0.1", "class_confusion=2",
                            "mask_noise=-1", "mask_noise=65", "mask_noise=1.5", "detect_every=0",
                            "pose_noise=-1", "pose_noise=nan", "depth_noise=11", "depth_noise=",
                            "drift=-1", "drift=0.3", "turn_drift=nan", "turn_drift=11"}) {
    const std::string key(wrong, std::strchr(wrong, '='));
    EXPECT_THAT(error_of(wrong), HasSubstr("synthetic: " + key + " is \"")) << wrong;
  }
  EXPECT_THAT(error_of("poses=3"), HasSubstr("pose_noise, drift, turn_drift, depth_noise"));
}

TEST(Disturbances, AreKeptInThePath) {
  for (const std::string path :
       {"synthetic:room", "synthetic:office?noise=none&frames=3&detection_rate=0.123456789",
        "synthetic:room?mask_noise=0&class_confusion=0.1&detect_every=4&pose_noise=1e-7",
        "synthetic:room?drift=0.005&turn_drift=0.2",
        "synthetic:room?depth_noise=0.3&rate=2.5&seed=18446744073709551615"}) {
    const auto options = ParseSyntheticPath(path);
    ASSERT_TRUE(options) << options.error().message;
    const auto again = ParseSyntheticPath(SyntheticPath(*options));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(SyntheticPath(*again), SyntheticPath(*options));
    EXPECT_EQ(again->detection_rate, options->detection_rate);
    EXPECT_EQ(again->mask_noise, options->mask_noise);
    EXPECT_EQ(again->pose_noise, options->pose_noise);
    EXPECT_EQ(again->drift, options->drift);
    EXPECT_EQ(again->turn_drift, options->turn_drift);
    EXPECT_EQ(again->seed, options->seed);
  }
}

TEST(Drift, GrowsWithTheWayAndLeavesTheImagesAsTheyAre) {
  const Sequence truth = Open("&frames=20");
  const Sequence drifted = Open("&frames=20&drift=0.01&turn_drift=0.5");
  double way = 0;
  for (size_t i = 0; i < truth.dataset->size(); ++i) {
    const Pose& T_W_C = truth.Header(i).T_W_C;
    if (i > 0) way += (T_W_C.translation() - truth.Header(i - 1).T_W_C.translation()).norm();
    const Eigen::Matrix3d turn = drifted.Header(i).T_W_C.linear() * T_W_C.linear().transpose();
    const Eigen::AngleAxisd expected(0.5 * way * M_PI / 180, Eigen::Vector3d::UnitZ());
    EXPECT_TRUE(turn.isApprox(expected.toRotationMatrix(), 1e-9)) << i;
  }
  EXPECT_GT(way, 5);
  EXPECT_EQ(truth.dataset->Read(19)->depth, drifted.dataset->Read(19)->depth);
  EXPECT_TRUE(SameDetections(truth.DetectionsOf(19), drifted.DetectionsOf(19)));
}

TEST(Drift, MakesTheWayLongerByItsShare) {
  const Sequence truth = Open("&frames=20"), longer = Open("&frames=20&drift=0.01");
  const Eigen::Vector3d start = truth.Header(0).T_W_C.translation();
  EXPECT_EQ(longer.Header(0).T_W_C.matrix(), truth.Header(0).T_W_C.matrix());
  for (size_t i = 1; i < truth.dataset->size(); ++i) {
    const Eigen::Vector3d expected = start + 1.01 * (truth.Header(i).T_W_C.translation() - start);
    EXPECT_TRUE(longer.Header(i).T_W_C.translation().isApprox(expected, 1e-9)) << i;
  }
}

size_t CountDetections(const Sequence& sequence) {
  size_t count = 0;
  for (size_t i = 0; i < sequence.dataset->size(); ++i)
    count += sequence.DetectionsOf(i).detections.size();
  return count;
}

TEST(DetectionRate, IsTheShareOfObjectsThatAreSeen) {
  const auto all = static_cast<double>(CountDetections(Open("&frames=80&detection_rate=1")));
  ASSERT_GT(all, 300);
  for (const double rate : {0.7, 0.3}) {
    const size_t seen = CountDetections(Open("&frames=80&detection_rate=" + std::to_string(rate)));
    EXPECT_NEAR(static_cast<double>(seen) / all, rate, 3 * std::sqrt(rate * (1 - rate) / all));
  }
  EXPECT_EQ(CountDetections(Open("&frames=4&detection_rate=0")), 0u);
}

TEST(DetectionRate, HoldsWithoutNoiseToo) {
  EXPECT_EQ(CountDetections(Open("&frames=8&noise=none&detection_rate=0")), 0u);
  EXPECT_EQ(CountDetections(Open("&frames=8&noise=none")),
            CountDetections(Open("&frames=8&noise=none&detection_rate=1")));
}

TEST(ClassConfusion, GivesThatShareAnotherClassOfTheScene) {
  const Sequence truth = Open("&frames=80"), confused = Open("&frames=80&class_confusion=0.3");
  std::set<ClassId> classes;
  std::map<ClassId, int> wrong;
  double all = 0, others = 0;
  for (size_t i = 0; i < truth.dataset->size(); ++i) {
    const DetectionSet a = truth.DetectionsOf(i), b = confused.DetectionsOf(i);
    ASSERT_EQ(a.detections.size(), b.detections.size());
    for (size_t k = 0; k < a.detections.size(); ++k) {
      classes.insert(a.detections[k].class_id);
      EXPECT_EQ(a.detections[k].mask, b.detections[k].mask);
      ++all;
      if (a.detections[k].class_id == b.detections[k].class_id) continue;
      ++others;
      ++wrong[b.detections[k].class_id];
    }
  }
  EXPECT_NEAR(others / all, 0.3, 3 * std::sqrt(0.3 * 0.7 / all));
  EXPECT_EQ(wrong.size(), classes.size()) << "every class is taken for another one";
  for (const auto& [class_id, count] : wrong) EXPECT_TRUE(classes.contains(class_id));
}

double Iou(const Mask& a, const Mask& b) {
  double common = 0, either = 0;
  for (int v = 0; v < a.image_height; ++v) {
    for (int u = 0; u < a.image_width; ++u) {
      common += a.Contains(v, u) && b.Contains(v, u);
      either += a.Contains(v, u) || b.Contains(v, u);
    }
  }
  return common / either;
}

/// Mean over all detections with more than 400 true pixels, so that none vanishes.
double MeanIou(int mask_noise) {
  const std::string all = "&frames=20&width=320&detection_rate=1&mask_noise=";
  const Sequence truth = Open(all + "0"), noisy = Open(all + std::to_string(mask_noise));
  double sum = 0, count = 0;
  for (size_t i = 0; i < truth.dataset->size(); ++i) {
    for (const Detection& detection : truth.DetectionsOf(i).detections) {
      double best = 0;
      for (const Detection& other : noisy.DetectionsOf(i).detections) {
        EXPECT_EQ(other.mask.image_width, 320);
        best = std::max(best, Iou(detection.mask, other.mask));
      }
      sum += best;
      ++count;
    }
  }
  return sum / count;
}

TEST(MaskNoise, MasksGetWorseByAndBy) {
  EXPECT_EQ(MeanIou(0), 1);
  double before = 1;
  for (const int noise : {1, 2, 3, 4, 6, 8}) {
    const double iou = MeanIou(noise);
    EXPECT_LT(iou, before) << noise;
    EXPECT_GT(iou, before - 0.3) << noise;
    before = iou;
  }
  EXPECT_GT(before, 0.3);
}

TEST(MaskNoise, BleedsOntoTheBackgroundAndLeavesHoles) {
  Image<uint16_t> ids(200, 150);
  Eigen::AlignedBox2i box(Eigen::Vector2i(60, 40), Eigen::Vector2i(139, 109));
  for (int v = 40; v < 110; ++v) {
    for (int u = 60; u < 140; ++u) ids(v, u) = 5;
  }
  int outside = 0, holes = 0;
  for (uint64_t key = 0; key < 20; ++key) {
    const Mask mask = NoisyMask(ids, 5, box, {.max_growth = 0, .waver = 2}, key);
    for (int v = 0; v < ids.height(); ++v) {
      for (int u = 0; u < ids.width(); ++u) {
        const bool deep = v >= 46 && v < 104 && u >= 66 && u < 134;  // three deviations inside
        outside += mask.Contains(v, u) && ids(v, u) != 5;
        holes += deep && !mask.Contains(v, u);
      }
    }
  }
  EXPECT_NEAR(holes / (20.0 * 58 * 68), 0.023, 0.01);
  EXPECT_NEAR(outside / 20.0, 300 * 2 / std::sqrt(2 * M_PI), 60);  // along a rim of 300 pixels
}

TEST(DetectEvery, TheDetectorDoesNotLookAtTheFramesBetween) {
  const Sequence sequence = Open("&frames=9&detect_every=4"), all = Open("&frames=9");
  for (size_t i = 0; i < 9; ++i) {
    const FrameHeader header = sequence.Header(i);
    EXPECT_TRUE(all.detections->DetectorRan(header));
    EXPECT_EQ(sequence.detections->DetectorRan(header), i % 4 == 0);
    if (i % 4 == 0) {
      EXPECT_TRUE(SameDetections(sequence.DetectionsOf(i), all.DetectionsOf(i)));
    } else {
      EXPECT_TRUE(sequence.DetectionsOf(i).detections.empty());
    }
  }
}

TEST(PoseNoise, MovesTheGivenPosesAndNotTheCamera) {
  const std::string plain = "&frames=300&width=16";
  const Sequence truth = Open(plain), noisy = Open(plain + "&pose_noise=0.02");
  Eigen::Vector3d moved = Eigen::Vector3d::Zero(), squares = moved, turns = moved;
  for (size_t i = 0; i < 300; ++i) {
    const Pose T_W_C = truth.Header(i).T_W_C, given = noisy.Header(i).T_W_C;
    EXPECT_TRUE(MakePose(given.matrix()));
    const Eigen::Vector3d error = given.translation() - T_W_C.translation();
    const Eigen::AngleAxisd turn(T_W_C.linear().transpose() * given.linear());
    moved += error / 300;
    squares += error.cwiseAbs2() / 300;
    turns += (turn.angle() * turn.axis()).cwiseAbs2() / 300;
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(std::abs(moved[axis]), 0.004);
    EXPECT_NEAR(std::sqrt(squares[axis]), 0.02, 0.003);
    EXPECT_NEAR(std::sqrt(turns[axis]) * 180 / M_PI, 0.5, 0.07);
  }
  EXPECT_EQ(noisy.dataset->Read(7)->depth, truth.dataset->Read(7)->depth);
  EXPECT_EQ(noisy.dataset->Read(7)->header.T_W_C.matrix(), noisy.Header(7).T_W_C.matrix());
  EXPECT_TRUE(SameDetections(noisy.DetectionsOf(7), truth.DetectionsOf(7)));
}

/// Deviation of depth from its true value between 1 and 3 m [m].
double DepthDeviation(const std::string& factor) {
  const std::string room = "&frames=4&width=640";
  const Sequence truth = Open(room + "&noise=none"), noisy = Open(room + "&depth_noise=" + factor);
  double squares = 0, count = 0;
  for (size_t i = 0; i < 4; ++i) {
    const Image<uint16_t> exact = truth.dataset->Read(i)->depth,
                          seen = noisy.dataset->Read(i)->depth;
    for (size_t k = 0; k < exact.size(); ++k) {
      const double z = 0.001 * exact.data()[k], error = 0.001 * seen.data()[k] - z;
      if (z < 1 || z > 3 || seen.data()[k] == 0) continue;
      squares += error * error;
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(DepthNoise, GrowsWithItsFactor) {
  const double kinect = DepthDeviation("1");
  EXPECT_GT(kinect, 0.002);
  EXPECT_LT(DepthDeviation("0"), 0.0003) << "whole millimetres";
  EXPECT_NEAR(DepthDeviation("0.5"), 0.5 * kinect, 0.05 * kinect);
  EXPECT_NEAR(DepthDeviation("3"), 3 * kinect, 0.2 * kinect);
}

}  // namespace
}  // namespace vismap
