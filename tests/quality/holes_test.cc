// Depth with holes, as drivers that register it to colour deliver it, maps as well as whole depth.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string>

#include "base/parallel.h"
#include "quality/mapped_sequence.h"
#include "segmentation/segment_frame.h"
#include "simulation/room.h"
#include "support/hole_patterns.h"
#include "support/mesh_scores.h"
#include "support/pipelines.h"

namespace vismap {
namespace {

using testing_support::GeometryScore;
using testing_support::HolePattern;

/// A sequence whose depth images have holes in a pattern.
class PunchedSequence : public Dataset {
 public:
  PunchedSequence(const Dataset& whole, const HolePattern& pattern)
      : whole_(whole), pattern_(pattern) {}

  std::string name() const override { return whole_.name(); }
  std::string format() const override { return whole_.format(); }
  size_t size() const override { return whole_.size(); }
  FrameHeader Header(size_t i) const override { return whole_.Header(i); }
  const std::vector<SkippedFrame>& skipped() const override { return whole_.skipped(); }
  std::optional<std::string> default_detections_path() const override {
    return whole_.default_detections_path();
  }
  Result<SensorFrame> Read(size_t i) const override {
    Result<SensorFrame> frame = whole_.Read(i);
    if (!frame) return frame;
    for (int v = 0; v < frame->depth.height(); ++v) {
      for (int u = 0; u < frame->depth.width(); ++u) {
        if (pattern_.is_hole(v, u)) frame->depth(v, u) = 0;
      }
    }
    return frame;
  }

 private:
  const Dataset& whole_;
  HolePattern pattern_;
};
/// How well the map of the built-in room is.
struct RoomScore {
  int found = 0;                          ///< objects with an IoU above 0.5
  double known_iou = 0, unknown_iou = 0;  ///< mean over the objects of the kind
  GeometryScore surface;
};

std::vector<uint16_t> TruthOfVertices(const Scene& scene, const Mesh& mesh) {
  std::vector<uint16_t> truth(mesh.vertices.size());
  ParallelFor(truth.size(), 256, [&](size_t i) {
    double nearest = 0.04;
    for (const SceneObject& object : scene.objects) {
      const Eigen::Vector3d p_W = mesh.vertices[i].position_W.cast<double>();
      const double distance = std::abs(SignedDistance(object, p_W));
      if (distance >= nearest) continue;
      nearest = distance;
      truth[i] = object.id;
    }
  });
  return truth;
}

RoomScore Score(const Mesh& mesh) {
  const Scene scene = MakeRoom();
  const auto scores = testing_support::ScoreObjects(mesh, TruthOfVertices(scene, mesh));
  RoomScore result;
  int known = 0, unknown = 0;
  for (const SceneObject& object : scene.objects) {
    const auto score = scores.find(object.id);
    if (object.kind == ObjectKind::kStructure || score == scores.end() ||
        score->second.vertices < 60)
      continue;
    const bool is_known = object.kind == ObjectKind::kKnown;
    ++(is_known ? known : unknown);
    (is_known ? result.known_iou : result.unknown_iou) += score->second.iou;
    result.found += score->second.iou > 0.5 ? 1 : 0;
  }
  result.known_iou /= known;
  result.unknown_iou /= unknown;
  result.surface = testing_support::ScoreGeometry(
      mesh, [&](const Eigen::Vector3d& p_W) { return SignedDistance(scene, p_W); });
  return result;
}

/// `pattern` = nullptr: without holes.
RoomScore MapRoom(const HolePattern* pattern) {
  const std::string name = "synthetic:room?frames=40";
  const auto whole = OpenSequence(name, "", {});
  const auto detections = OpenDetections(name);
  if (!whole || !detections) throw std::runtime_error("the room can be opened");
  std::optional<PunchedSequence> punched;
  if (pattern != nullptr) punched.emplace(**whole, *pattern);
  const Dataset& dataset = punched ? static_cast<const Dataset&>(*punched) : **whole;
  MapSession session(testing_support::Mapped::Options(), {});
  StageTimes times;
  const auto mapped = MapSequence(
      {dataset, detections->get()}, {}, [](size_t) { return true; }, &session, &times);
  if (!mapped) throw std::runtime_error(mapped.error().message);
  OutputOptions options;
  options.objects.min_part_contact = 0;  // parts as the map has them; joined ones are another test
  return Score(MakeProducts(session.map(), session.metadata(), options).mesh);
}

// Those that must not change the scores; others are in tests/segmentation/holes_test.cc.
const std::set<std::string> kPatterns{"every 4th row and column", "every 5th row and column",
                                      "every 3rd column", "checkerboard", "30 % at random"};

TEST(Holes, ARoomSeenThroughThemIsMappedAsWell) {
  const RoomScore whole = MapRoom(nullptr);
  ASSERT_GE(whole.found, 10);
  for (const HolePattern& pattern : testing_support::HolePatterns()) {
    if (!kPatterns.contains(pattern.name)) continue;
    SCOPED_TRACE(pattern.name);
    const RoomScore score = MapRoom(&pattern);
    std::printf("%s: found %d, IoU of known %.3f, of unknown %.3f, surface %.2f mm, %ld vertices\n",
                pattern.name.c_str(), score.found, score.known_iou, score.unknown_iou,
                1e3 * score.surface.mean, static_cast<long>(score.surface.vertices));
    EXPECT_GE(score.found, whole.found);
    EXPECT_GT(score.known_iou, whole.known_iou - 0.02);
    EXPECT_GT(score.unknown_iou, whole.unknown_iou - 0.02);
    EXPECT_LT(score.surface.mean, whole.surface.mean + 3e-4);
    EXPECT_GT(static_cast<double>(score.surface.vertices),
              0.96 * static_cast<double>(whole.surface.vertices));
  }
}

// A RealSense before a box of things; its driver registered depth to colour. Two thirds of the
// pixels have no depth.
TEST(Holes, ThingsInDepthThatADriverRegisteredToColourAreSegments) {
  const auto path = testing_support::RecordedSequence("apc_box/box");
  if (!path) GTEST_SKIP() << "VISMAP_DATA is not set, or has no apc_box";
  const testing_support::InputSequence sequence(*path);
  ASSERT_GT(sequence.size(), 10u);
  for (size_t i = 0; i < sequence.size(); ++i) {
    const SegmentedFrame frame = SegmentFrame(sequence.Read(i).frame, nullptr, {});
    int64_t with_depth = 0, in_segments = 0;
    for (const float z : frame.frame.depth.pixels()) with_depth += z > 0 ? 1 : 0;
    for (const FrameSegment& segment : frame.segments) in_segments += segment.pixels;
    EXPECT_GT(2 * in_segments, with_depth) << i;
    EXPECT_GE(frame.segments.size(), 3u) << i;
  }
}

}  // namespace
}  // namespace vismap
