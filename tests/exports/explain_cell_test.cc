#include "exports/explain_cell.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "freespace/occupancy_map.h"
#include "support/sphere_map.h"

namespace vismap {
namespace {

using testing_support::kSphereCenter;
using testing_support::kSphereGrid;
using testing_support::kSphereRadius;
using testing_support::SphereMap;

nlohmann::json Explain(const SemanticMap& map, const Eigen::Vector3d& p_W,
                       const OccupancyOptions& options = {}) {
  MapMetadata metadata;
  metadata.map_id = "sphere";
  const Result<std::string> text = ExplainCell(map, metadata, options, p_W, ClassName);
  return text ? nlohmann::json::parse(*text) : nlohmann::json();
}

TEST(ExplainCell, DistanceIsThatOfTheSphereAndTheStateThatOfFreeSpace) {
  const SemanticMap map = SphereMap();
  const OccupancyMap space = ClassifyMap(map, {});
  int near = 0;
  for (double x = -0.55; x < 0.55; x += 0.013) {
    const Eigen::Vector3d p_W(x, 0.05, -0.02);
    const auto json = Explain(map, p_W);
    const std::string states[] = {"unknown", "free", "occupied"};
    EXPECT_EQ(json["state"], states[static_cast<size_t>(space.At(p_W))]);
    if (json["distance_m"].is_null()) continue;
    ++near;
    const Eigen::Vector3d center(json["center"][0], json["center"][1], json["center"][2]);
    const double truncation = kSphereGrid.truncation_voxels * kSphereGrid.voxel_size_m;
    const double distance = (center - kSphereCenter).norm() - kSphereRadius;
    EXPECT_NEAR(json["distance_m"].get<double>(), std::clamp(distance, -truncation, truncation),
                1e-4);
    EXPECT_LE((center - p_W).cwiseAbs().maxCoeff(), 0.5 * kSphereGrid.voxel_size_m + 1e-9);
  }
  EXPECT_GT(near, 10);
}

TEST(ExplainCell, LabelsHaveTheirVotesAndWhatTheyShow) {
  SemanticMap map = SphereMap();
  const Eigen::Vector3d low = kSphereCenter - Eigen::Vector3d(kSphereRadius, 0, 0);
  const auto json = Explain(map, low);
  ASSERT_EQ(json["labels"].size(), 1u);
  EXPECT_EQ(json["labels"][0]["label"], 1);
  EXPECT_GT(json["labels"][0]["votes"], 0);
  EXPECT_EQ(json["shown"]["segment"], 1);
  EXPECT_EQ(json["shown"]["instance"], 0);
  EXPECT_EQ(json["color"], nlohmann::json({10, 200, 30}));
  EXPECT_EQ(json["block"], "surface");

  const InstanceId cup{1};
  map.labels.GrowInstances(InstanceId{2});
  LabelRecord& record = map.labels.MutableRecord(SegmentLabel{1});
  record.frames = record.frames_with_detector = 5;
  record.instance_evidence[cup] = 5;
  record.class_evidence[ClassId{47}] = 5;
  map.labels.Merge(SegmentLabel{1}, SegmentLabel{2});
  const Eigen::Vector3d high = kSphereCenter + Eigen::Vector3d(kSphereRadius, 0, 0);
  const auto merged = Explain(map, high);
  EXPECT_EQ(merged["labels"][0]["label"], 2);
  EXPECT_EQ(merged["labels"][0]["shown_as"], 1);
  EXPECT_EQ(merged["shown"]["instance"], 1);
  EXPECT_EQ(merged["shown"]["class_name"], "cup");
}

TEST(ExplainCell, WhySaysWhichRuleDecided) {
  const SemanticMap map = SphereMap();
  const auto at = [&](double radius, const OccupancyOptions& options = {}) {
    return Explain(map, kSphereCenter + Eigen::Vector3d(radius, 0, 0), options)["why"]
        .get<std::string>();
  };
  EXPECT_THAT(at(kSphereRadius), testing::HasSubstr("at most 0.0200 m"));
  EXPECT_THAT(at(kSphereRadius + 0.07), testing::HasSubstr("before the surface"));
  EXPECT_THAT(at(kSphereRadius, {.min_observations = 100}), testing::HasSubstr("needed: 100"));
  EXPECT_EQ(Explain(map, {50, 0, 0})["why"], "no frame has seen it");
  EXPECT_EQ(Explain(map, {50, 0, 0})["block"], "unseen");
}

TEST(ExplainCell, ThinThingsAreOccupiedByTheirHits) {
  SemanticMap map = SphereMap();
  Block& block = map.voxels.FindOrCreate({100, 0, 0});
  block.all_free = true;
  block.thin = std::make_unique<ThinVoxels>();
  block.thin.Own().hits[0] = 4;
  const auto json = Explain(map, {100 * map.voxels.block_size() + 0.001, 0.001, 0.001});
  EXPECT_EQ(json["state"], "occupied");
  EXPECT_EQ(json["thin_hits"], 4);
  EXPECT_THAT(json["why"].get<std::string>(), testing::HasSubstr("thin"));
  const auto beside = Explain(map, {100 * map.voxels.block_size() + 0.05, 0.001, 0.001});
  EXPECT_EQ(beside["state"], "free");
  EXPECT_EQ(beside["block"], "all_free");
}

TEST(ExplainCell, LastFrameIsThatOfTheBlock) {
  SemanticMap map = SphereMap();
  const Eigen::Vector3d p_W = kSphereCenter + Eigen::Vector3d(kSphereRadius, 0, 0);
  EXPECT_TRUE(Explain(map, p_W)["last_frame"].is_null());
  const Eigen::Vector3d block = (p_W / map.voxels.block_size()).array().floor();
  const BlockIndex index{static_cast<int>(block.x()), static_cast<int>(block.y()),
                         static_cast<int>(block.z())};
  map.voxels.MarkUsed(index, *map.voxels.FindMutable(index), 2);
  MapMetadata metadata;
  metadata.trajectory = {{10, CameraId{0}, Pose::Identity()}, {20, CameraId{3}, Pose::Identity()}};
  const auto json = nlohmann::json::parse(*ExplainCell(map, metadata, {}, p_W, ClassName));
  EXPECT_EQ(json["last_frame"], nlohmann::json({{"revision", 2}, {"camera_id", 3}, {"utime", 20}}));
}

TEST(ExplainCell, PointsFarAwayAreRefused) {
  const SemanticMap map = SphereMap();
  for (const double x : {1e6, -1e300, std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::quiet_NaN()})
    EXPECT_TRUE(Explain(map, {x, 0, 0}).is_null());
}

}  // namespace
}  // namespace vismap
