#include "segmentation/segment_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/parallel.h"
#include "geometry/compute_surface.h"
#include "support/analytic_depth.h"
#include "support/published_options.h"

namespace vismap {
namespace {

using testing_support::PublishedOptions;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

SegmentImage Segment(const Image<float>& depth, const DepthNoiseModel& noise = KinectNoise(),
                     const PinholeCamera& camera = kVga) {
  SegmentationStageOptions options;
  options.surface.noise = noise;
  return SegmentDepth(ComputeSurface(depth, camera, options.surface), camera, options.segmentation);
}

/// Pixels per (shape, segment); segment -1 = none.
std::map<std::pair<int, int>, int> Table(const TestView& view, const SegmentImage& segments) {
  std::map<std::pair<int, int>, int> table;
  for (int v = 0; v < view.shape.height(); ++v) {
    for (int u = 0; u < view.shape.width(); ++u) {
      if (view.shape(v, u) >= 0) ++table[{view.shape(v, u), Raw(segments.index(v, u))}];
    }
  }
  return table;
}

/// Best intersection over union of a shape with a segment.
double BestIou(const TestView& view, const SegmentImage& segments, int shape) {
  const auto table = Table(view, segments);
  int pixels = 0;
  std::map<int, int> of_segment;
  for (const auto& [key, count] : table) {
    if (key.first == shape) pixels += count;
    of_segment[key.second] += count;
  }
  double best = 0;
  for (const auto& [key, count] : table) {
    if (key.first != shape || key.second < 0) continue;
    best = std::max(best, static_cast<double>(count) / (pixels + of_segment[key.second] - count));
  }
  return best;
}

TestScene Plane(double z) { return {{{Eigen::Vector3d(0, 0, 1), z}}, {}}; }

TestScene SphereBeforeWall() {
  return {{{Eigen::Vector3d(0, 0, 1), 1.6}}, {{Eigen::Vector3d(0, 0, 1.2), 0.2}}};
}

/// Two planes that meet in the vertical line x = 0, z = 1.5 at the given opening angle.
TestScene Fold(double half_angle_deg, bool concave) {
  const double a = half_angle_deg * 3.14159265358979323846 / 180;
  const double sign = concave ? 1 : -1;
  const Eigen::Vector3d left(-sign * std::cos(a), 0, std::sin(a));
  const Eigen::Vector3d right(sign * std::cos(a), 0, std::sin(a));
  // Concave: z shrinks away from the fold on both sides: a corner of a room seen from inside.
  return {{{left, 1.5 * std::sin(a), [](const Eigen::Vector3d& p) { return p.x() <= 0; }},
           {right, 1.5 * std::sin(a), [](const Eigen::Vector3d& p) { return p.x() > 0; }}},
          {}};
}

TEST(SegmentDepth, PlaneIsOneSegmentOfAllItsPixels) {
  for (const double z : {0.5, 1.0, 3.0, 5.0}) {
    const SegmentImage segments = Segment(Render(Plane(z)).depth);
    EXPECT_EQ(segments.segment_count, 1) << z;
    for (const SegmentIndex index : segments.index.pixels()) ASSERT_EQ(Raw(index), 0);
  }
}

TEST(SegmentDepth, ConcaveFoldSplitsExactlyAlongTheFold) {
  const TestView view = Render(Fold(45, true));
  const SegmentImage segments = Segment(view.depth);
  EXPECT_EQ(segments.segment_count, 2);
  for (int v = 0; v < kVga.height; ++v) {
    for (int u = 0; u < kVga.width; ++u) {
      if (std::abs(u - kVga.cx) < 2) continue;  // the published test allows two pixels, too
      ASSERT_EQ(Raw(segments.index(v, u)), u < kVga.cx ? 0 : 1) << v << " " << u;
    }
  }
}

TEST(SegmentDepth, ConcaveFoldSplitsInNoiseToo) {
  const TestView view = Render(Fold(45, true));
  for (const uint64_t seed : {1u, 2u, 3u}) {
    const SegmentImage segments = Segment(AddNoise(view.depth, KinectNoise(), 3, seed));
    EXPECT_EQ(segments.segment_count, 2);
    EXPECT_GT(BestIou(view, segments, 0), 0.98);
    EXPECT_GT(BestIou(view, segments, 1), 0.98);
  }
}

TEST(SegmentDepth, ConvexFoldStaysWhole) {
  const TestView view = Render(Fold(45, false));
  EXPECT_EQ(Segment(view.depth).segment_count, 1);
  EXPECT_EQ(Segment(AddNoise(view.depth, KinectNoise(), 3, 5)).segment_count, 1);
}

TEST(SegmentDepth, SphereBeforeWallIsTwoSegments) {
  const TestView view = Render(SphereBeforeWall());
  for (const Image<float>& depth : {view.depth, AddNoise(view.depth, KinectNoise(), 3, 11)}) {
    const SegmentImage segments = Segment(depth);
    EXPECT_EQ(segments.segment_count, 2);
    EXPECT_GT(BestIou(view, segments, 0), 0.98);
    EXPECT_GT(BestIou(view, segments, 1), 0.95);
  }
}

TEST(SegmentDepth, StaircaseSplitsAtEveryStep) {
  TestScene scene;
  scene.planes = {
      {Eigen::Vector3d(0, 0, 1), 1.0,
       [](const Eigen::Vector3d& p) { return p.x() / p.z() < -0.2; }},
      {Eigen::Vector3d(0, 0, 1), 1.2, [](const Eigen::Vector3d& p) { return p.x() / p.z() < 0.2; }},
      {Eigen::Vector3d(0, 0, 1), 1.4}};
  const TestView view = Render(scene);
  for (const Image<float>& depth : {view.depth, AddNoise(view.depth, KinectNoise(), 3, 13)}) {
    const SegmentImage segments = Segment(depth);
    EXPECT_EQ(segments.segment_count, 3);
    for (int shape = 0; shape < 3; ++shape) EXPECT_GT(BestIou(view, segments, shape), 0.98);
  }
}

TEST(SegmentDepth, HoleInAPlaneDoesNotSplitItAndBelongsToNothing) {
  TestView view = Render(Plane(1.5));
  for (int v = 100; v < 380; ++v) {
    for (int u = 300; u < 330; ++u) view.depth(v, u) = kNaN;
  }
  const SegmentImage segments = Segment(AddNoise(view.depth, KinectNoise(), 3, 17));
  EXPECT_EQ(segments.segment_count, 1);
  for (int v = 0; v < kVga.height; ++v) {
    for (int u = 0; u < kVga.width; ++u) {
      ASSERT_EQ(segments.index(v, u) == SegmentIndex::kNone, std::isnan(view.depth(v, u)));
    }
  }
}

TEST(SegmentDepth, SlantedFloorToFiveMetresStaysOneSegment) {
  // Camera 0.8 m and 1.2 m above a floor, looking 20 degrees down.
  for (const double height : {0.8, 1.2}) {
    const Eigen::Vector3d down(0, std::cos(0.35), std::sin(0.35));
    TestView view = Render({{{down, height}}, {}});
    int pixels = 0;
    for (float& z : view.depth.pixels()) {
      if (z > 5) z = kNaN;
      pixels += z == z;
    }
    for (const Image<float>& depth : {view.depth, AddNoise(view.depth, KinectNoise(), 3, 19)}) {
      const SegmentImage segments = Segment(depth);
      EXPECT_EQ(segments.segment_count, 1) << height;
      int in = 0;
      for (const SegmentIndex index : segments.index.pixels()) in += index != SegmentIndex::kNone;
      EXPECT_GT(in, pixels * 99 / 100);
    }
  }
}

TEST(SegmentDepth, WallAtRangeDoesNotShatterInKinectNoise) {
  for (const double z : {2.0, 3.0, 4.0, 5.0}) {
    const TestView view = Render({{{Eigen::Vector3d(0.3, 0.1, 1).normalized(), z}}, {}});
    for (const uint64_t seed : {1u, 2u}) {
      const SegmentImage segments = Segment(AddNoise(view.depth, KinectNoise(), 3, seed));
      EXPECT_EQ(segments.segment_count, 1) << z;
      EXPECT_GT(BestIou(view, segments, 0), 0.97) << z;
    }
  }
}

TEST(SegmentDepth, BoxOnTheFloorIsApartFromItWithItsFacesTogether) {
  // Frame: y down, floor at y = 0.6; the box stands at x in [-0.2, 0.2], 0.25 m high.
  TestScene scene;
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  static Eigen::Matrix3d to_level;
  to_level = tilt.transpose();
  const auto level_plane = [&](const Eigen::Vector3d& normal, double offset) {
    return std::pair<Eigen::Vector3d, double>(to_level.transpose() * normal, offset);
  };
  const auto [floor, floor_offset] = level_plane({0, 1, 0}, 0.8);
  const auto [top, top_offset] = level_plane({0, 1, 0}, 0.55);
  const auto [front, front_offset] = level_plane({0, 0, 1}, 1.2);
  scene.planes = {{floor, floor_offset},
                  {top, top_offset,
                   [](const Eigen::Vector3d& p) {
                     const Eigen::Vector3d q = to_level * p;
                     return std::abs(q.x()) < 0.2 && q.z() > 1.2 && q.z() < 1.5;
                   }},
                  {front, front_offset, [](const Eigen::Vector3d& p) {
                     const Eigen::Vector3d q = to_level * p;
                     return std::abs(q.x()) < 0.2 && q.y() > 0.55 && q.y() < 0.8;
                   }}};
  TestView view = Render(scene);
  for (float& z : view.depth.pixels()) z = z < 5 ? z : kNaN;
  for (int& shape : view.shape.pixels()) shape = shape == 2 ? 1 : shape;  // top and front: one box
  for (const Image<float>& depth : {view.depth, AddNoise(view.depth, KinectNoise(), 3, 23)}) {
    const SegmentImage segments = Segment(depth);
    EXPECT_EQ(segments.segment_count, 2);
    EXPECT_GT(BestIou(view, segments, 1), 0.93);
  }
}

TEST(SegmentDepth, SpecksBelowTheMinimumJoinNothingAcrossADepthJump) {
  TestScene scene = Plane(2.0);
  scene.spheres = {{Eigen::Vector3d(0, 0, 1.0), 0.02}};  // about 21 px across: below 500 px
  const TestView view = Render(scene);
  const SegmentImage segments = Segment(view.depth);
  EXPECT_EQ(segments.segment_count, 1);
  EXPECT_EQ(segments.index(240, 320), SegmentIndex::kNone);
  SegmentationStageOptions options;
  options.segmentation.min_segment_px = 100;
  const SegmentImage finer =
      SegmentDepth(ComputeSurface(view.depth, kVga, options.surface), kVga, options.segmentation);
  EXPECT_EQ(finer.segment_count, 2);
}

TEST(SegmentDepth, MinimumSizeScalesWithTheImage) {
  const PinholeCamera half{320, 240, 262.5, 262.5, 159.5, 119.5};
  TestScene scene = Plane(2.0);
  scene.spheres = {{Eigen::Vector3d(0, 0, 1.0), 0.03}};  // 780 px at 640x480, 190 px here
  const SegmentImage whole = Segment(Render(scene).depth);
  const SegmentImage small = Segment(Render(scene, half).depth, KinectNoise(), half);
  EXPECT_EQ(whole.segment_count, 2);
  EXPECT_EQ(small.segment_count, 2);
}

TEST(SegmentDepth, SegmentsAreNumberedWithoutGapsByTheirFirstPixel) {
  const SegmentImage segments =
      Segment(AddNoise(Render(SphereBeforeWall()).depth, KinectNoise(), 3, 29));
  int next = 0;
  for (const SegmentIndex index : segments.index.pixels()) {
    ASSERT_LE(Raw(index), next);
    if (Raw(index) == next) ++next;
  }
  EXPECT_EQ(next, segments.segment_count);
}

TEST(SegmentDepth, SegmentsAreConnectedAndOfTheMinimumSize) {
  const SegmentImage segments =
      Segment(AddNoise(Render(SphereBeforeWall()).depth, KinectNoise(), 3, 31));
  const Image<SegmentIndex>& index = segments.index;
  Image<uint8_t> seen(index.width(), index.height());
  std::set<SegmentIndex> met;
  for (int v = 0; v < index.height(); ++v) {
    for (int u = 0; u < index.width(); ++u) {
      if (seen(v, u) || index(v, u) == SegmentIndex::kNone) continue;
      ASSERT_TRUE(met.insert(index(v, u)).second) << "segment in two pieces";
      std::vector<std::pair<int, int>> open{{v, u}};
      seen(v, u) = 1;
      for (size_t i = 0; i < open.size(); ++i) {
        const auto [y, x] = open[i];
        for (const auto& [dy, dx] : {std::pair{0, 1}, {1, 0}, {0, -1}, {-1, 0}}) {
          if (!index.Contains(y + dy, x + dx) || seen(y + dy, x + dx)) continue;
          if (index(y + dy, x + dx) != index(v, u)) continue;
          seen(y + dy, x + dx) = 1;
          open.emplace_back(y + dy, x + dx);
        }
      }
      EXPECT_GE(open.size(), 500u);
    }
  }
}

TEST(SegmentDepth, SameImageForAnyNumberOfThreadsAndTwice) {
  const Image<float> depth = AddNoise(Render(SphereBeforeWall()).depth, KinectNoise(), 3, 37);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return Segment(depth).index;
  };
  const auto one = run(1);
  EXPECT_EQ(one, run(1));
  EXPECT_EQ(one, run(4));
}

TEST(SegmentDepth, NoDepthGivesNoSegments) {
  const SegmentImage segments = Segment(Image<float>(kVga.width, kVga.height, kNaN));
  EXPECT_EQ(segments.segment_count, 0);
  const PinholeCamera dot{1, 1, 500, 500, 0, 0};
  EXPECT_EQ(Segment(Image<float>(1, 1, 1.0F), KinectNoise(), dot).segment_count, 1);
}

TEST(SegmentDepth, WorksWithTheNoiseOfOtherSensors) {
  for (const DepthNoiseModel& noise : {RealSenseNoise(), CleanNoise()}) {
    const TestView view = Render(SphereBeforeWall());
    const SegmentImage segments = Segment(AddNoise(view.depth, noise, 3, 41), noise);
    EXPECT_EQ(segments.segment_count, 2);
    EXPECT_GT(BestIou(view, segments, 1), 0.95);
  }
}

TEST(SegmentDepth, ASurfaceOfAnotherSizeThrows) {
  const SurfaceMap surface = ComputeSurface(Render(Plane(1)).depth, kVga, SurfaceOptions{});
  EXPECT_THROW(SegmentDepth(surface, {2, 2, 500, 500, 1, 1}, SegmentationOptions{}),
               std::logic_error);
}

TEST(PublishedSegmentation, DoesWhatThePaperShowsOnCleanDepth) {
  const SegmentationStageOptions options = PublishedOptions();
  const auto run = [&](const TestScene& scene) {
    return SegmentDepth(ComputeSurface(Render(scene).depth, kVga, options.surface), kVga,
                        options.segmentation);
  };
  EXPECT_EQ(run(Plane(1.5)).segment_count, 1);
  EXPECT_EQ(run(Fold(45, true)).segment_count, 2);
  EXPECT_EQ(run(Fold(75, false)).segment_count,
            1);  // a fold of 90 degrees would be split, since the normals are smoothed
  EXPECT_EQ(run(SphereBeforeWall()).segment_count, 2);
}

TEST(SegmentationOptions, ValidateNamesEveryProblem) {
  EXPECT_TRUE(Validate(SegmentationStageOptions{}).empty());
  EXPECT_TRUE(Validate(PublishedOptions()).empty());
  SegmentationStageOptions bad;
  bad.surface.min_radius_px = 0;
  bad.segmentation.concave_angle_deg = std::numeric_limits<double>::quiet_NaN();
  bad.segmentation.give_back_window_px = 8;
  bad.refine.min_overlap = 1.5;
  const auto problems = Validate(bad);
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_NE(problems[0].find("surface.min_radius_px"), std::string::npos);
  EXPECT_NE(problems[1].find("segmentation.concave_angle_deg"), std::string::npos);
  EXPECT_NE(problems[3].find("refine.min_overlap"), std::string::npos);
}

}  // namespace
}  // namespace vismap
