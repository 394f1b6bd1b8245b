#include "evaluation/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/report.h"

namespace vismap {
namespace {

constexpr float kGap = 0.01f;  // between points of a row [m]

// A ground truth of points in a row along x, and a map of it.
struct Row {
  GroundTruth truth;
  EvaluatedMap map;

  Row() { truth.format = "scenenn"; }
  void Object(uint32_t label, const char* name, ClassId class_id, bool is_structure = false) {
    truth.objects.push_back(
        {.label = label, .name = name, .class_id = class_id, .is_structure = is_structure});
  }
  // Adds points to the ground truth and, if `mapped`, to the map.
  void Add(int count, uint32_t label, uint32_t segment, uint32_t instance, uint16_t class_id,
           bool mapped = true) {
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3f p(static_cast<float>(truth.points_W.size()) * kGap, 0, 0);
      truth.points_W.push_back(p);
      truth.labels.push_back(label);
      if (!mapped) continue;
      MeshVertex vertex;
      vertex.position_W = p + Eigen::Vector3f(0, 0, 0.002f);
      vertex.segment = SegmentLabel{segment};
      vertex.instance = InstanceId{instance};
      vertex.class_id = ClassId{class_id};
      map.mesh.vertices.push_back(vertex);
    }
  }
};

// A chair, a fifth of which is a separate segment; a lamp that the map calls a chair; an object
// that was discovered; a floor into which a table reaches; and a table that was not mapped.
Row MakeRow() {
  Row row;
  row.Object(1, "chair", ClassId{62});
  row.Object(2, "lamp", ClassId::kUnknown);
  row.Object(3, "box", ClassId::kUnknown);
  row.Object(4, "floor", ClassId::kUnknown, true);
  row.Object(5, "table", ClassId{67});
  row.Add(160, 1, 1, 1, 62);
  row.Add(40, 1, 2, 0, 0);
  row.Add(100, 2, 3, 2, 62);
  row.Add(100, 3, 4, 0, 0);
  row.Add(90, 4, 5, 0, 0);
  row.Add(10, 4, 6, 3, 67);
  row.Add(100, 5, 0, 0, 0, false);
  return row;
}

TEST(Evaluation, CountsThingsOfAnyClass) {
  const Row row = MakeRow();
  const AnyClassScore score = Evaluate(row.truth, row.map, PaperClasses()).any_class;
  EXPECT_EQ(score.known.objects, 2);
  EXPECT_DOUBLE_EQ(score.known.recall50.value(), 0.5);
  // 160 / 200 of the chair; 4 points of the table are within 5 cm of the floor in instance 3
  EXPECT_DOUBLE_EQ(score.known.mean_iou.value(), 0.5 * (0.8 + 4.0 / 110));
  EXPECT_EQ(score.unknown.objects, 2);
  EXPECT_DOUBLE_EQ(score.unknown.recall50.value(), 1);
  EXPECT_EQ(score.unknown_given_a_class, 1);
  EXPECT_DOUBLE_EQ(score.fragments_per_object.value(), 1.0);  // 2, 1, 1, 0
  EXPECT_DOUBLE_EQ(score.structure_named_object.value(), 0.1);
}

TEST(Evaluation, ScoresClassesOnTheTruthsPoints) {
  const Row row = MakeRow();
  const Evaluation evaluation = Evaluate(row.truth, row.map, PaperClasses());
  const ClassEvaluation& chair = evaluation.classes[1];
  EXPECT_EQ(chair.at50.truths, 1);
  EXPECT_EQ(chair.at50.predictions, 2);
  EXPECT_EQ(chair.at50.false_positives(), 0);  // the lamp is void
  EXPECT_DOUBLE_EQ(chair.constant.ap50.value(), 1);
  EXPECT_FALSE(chair.with_score);                                // no scores were given
  EXPECT_DOUBLE_EQ(chair.ranked.ap50.value(), 1);                // the larger one first
  EXPECT_DOUBLE_EQ(evaluation.constant_mean.ap50.value(), 0.5);  // the table was missed
  EXPECT_EQ(evaluation.pred_instances, 3);
}

TEST(Evaluation, TakesScoresAsConfidences) {
  Row row = MakeRow();
  row.truth.objects[1].class_id = ClassId{67};  // what the map calls a chair is a table
  row.map.scores = {{InstanceId{1}, 0.9}, {InstanceId{2}, 0.5}};
  const std::vector<EvaluatedClass> classes = PaperClasses();
  EXPECT_DOUBLE_EQ(Evaluate(row.truth, row.map, classes).classes[1].with_score->ap50.value(), 1);
  row.map.scores = {{InstanceId{1}, 0.5}, {InstanceId{2}, 0.9}};
  const Evaluation evaluation = Evaluate(row.truth, row.map, classes);
  EXPECT_DOUBLE_EQ(evaluation.classes[1].with_score->ap50.value(), 0.25);  // r = 1, p = 1/2
  EXPECT_DOUBLE_EQ(evaluation.classes[1].constant.ap50.value(), 0.75);
}

TEST(Evaluation, MeasuresTheSurfaceBothWays) {
  const Row row = MakeRow();
  const SurfaceError error = Evaluate(row.truth, row.map, PaperClasses()).surface;
  EXPECT_NEAR(error.accuracy->mean, 0.002, 1e-6);
  EXPECT_EQ(error.accuracy->samples, 500u);
  EXPECT_DOUBLE_EQ(error.completeness->within_radius, 504.0 / 600);  // 4 points lie within 5 cm
  EXPECT_NEAR(error.completeness->median, 0.002, 1e-6);
}

TEST(Evaluation, DistancesAreToTrianglesWhereThereAreSome) {
  GroundTruth truth;
  truth.points_W = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  truth.labels = {0, 0, 0};
  EvaluatedMap map;
  map.mesh.vertices.resize(2);
  map.mesh.vertices[0].position_W = {0.3f, 0.3f, 0.25f};
  map.mesh.vertices[1].position_W = {0.5f, -0.75f, 0};
  EXPECT_GT(Evaluate(truth, map, {}).surface.accuracy->mean, 0.6);
  truth.triangles = {{0, 1, 2}};
  EXPECT_NEAR(Evaluate(truth, map, {}).surface.accuracy->mean, 0.5, 1e-7);
}

TEST(Evaluation, OfAnEmptyMapOrTruthIsNoAccident) {
  const Row row = MakeRow();
  const Evaluation of_nothing = Evaluate(row.truth, {}, PaperClasses());
  EXPECT_FALSE(of_nothing.surface.accuracy);
  EXPECT_EQ(of_nothing.surface.completeness->within_radius, 0);
  EXPECT_EQ(of_nothing.constant_mean.ap50, 0);
  const Evaluation against_nothing = Evaluate({}, row.map, PaperClasses());
  EXPECT_FALSE(against_nothing.constant_mean.ap50);
  EXPECT_FALSE(EvaluationJson(of_nothing).empty());
  EXPECT_FALSE(EvaluationTable(against_nothing).empty());
}

TEST(Evaluation, FindsSurfaceInFreeCellsAndObstaclesThatAreNotThere) {
  OccupancyMap map(0.1);
  OccupancyPlanes planes;
  planes.free[0] = 0b00000111;
  planes.occupied[0] = 0b10010000;  // cells x = 4 and 7 of the first row
  map.Set({0, 0, 0}, BlockOccupancy(planes));
  const std::vector<Eigen::Vector3f> points{
      {0.25f, 0.05f, 0.05f}, {0.45f, 0.05f, 0.05f}, {0.35f, 0.05f, 0.05f}, {9, 9, 9}};
  const CellShares shares = CellsAt(map, points);
  EXPECT_EQ(shares.samples, 4);
  EXPECT_EQ(shares.free, 1);
  EXPECT_EQ(shares.occupied, 1);
  EXPECT_EQ(shares.unknown, 2);
  const OccupiedCells occupied = CountOccupied(map, points, 0.15);
  EXPECT_EQ(occupied.cells, 2);
  EXPECT_EQ(occupied.far_from_truth, 1);
}

TEST(Evaluation, SaysWhatBecameOfEachObject) {
  Row row;
  row.Object(1, "stool", ClassId::kUnknown);
  row.Object(2, "pillow", ClassId::kUnknown);
  row.Object(3, "bed", ClassId{65});
  row.Object(4, "lamp", ClassId::kUnknown);
  row.Object(5, "ceiling", ClassId::kUnknown, true);
  row.Object(6, "curtain", ClassId::kUnknown);
  row.Add(80, 1, 1, 0, 0);  // a stool in three pieces, the last of which is no tenth
  row.Add(105, 1, 2, 0, 0);
  row.Add(15, 1, 3, 0, 0);
  row.Add(400, 3, 4, 1, 65);  // the bed, with the pillow
  row.Add(100, 2, 4, 1, 65);
  row.Add(90, 4, 5, 0, 0);  // most of the lamp belongs to the ceiling
  row.Add(10, 4, 6, 0, 0);
  row.Add(500, 5, 5, 0, 0);
  row.Add(100, 6, 0, 0, 0, false);
  const Evaluation evaluation = Evaluate(row.truth, row.map, PaperClasses());
  ASSERT_EQ(evaluation.findings.size(), 5u) << "all but the ceiling";
  const ObjectFinding &stool = evaluation.findings[0], &pillow = evaluation.findings[1],
                      &bed = evaluation.findings[2], &lamp = evaluation.findings[3],
                      &curtain = evaluation.findings[4];
  EXPECT_EQ(stool.found, FoundAs::kFound);  // 105 of 200
  EXPECT_EQ(stool.pieces, 2);
  EXPECT_EQ(pillow.found, FoundAs::kSwallowed);
  EXPECT_DOUBLE_EQ(pillow.covered, 1);
  EXPECT_DOUBLE_EQ(pillow.purity, 0.2);
  EXPECT_DOUBLE_EQ(pillow.iou, 0.2);
  EXPECT_EQ(pillow.shared_with, 2u);
  EXPECT_EQ(bed.found, FoundAs::kFound);
  EXPECT_EQ(lamp.found, FoundAs::kSwallowed);
  EXPECT_DOUBLE_EQ(lamp.in_largest, 0.9);
  EXPECT_EQ(lamp.shared_with, 4u);
  EXPECT_EQ(curtain.found, FoundAs::kMissing);  // but for 4 points within 5 cm of the ceiling
}

TEST(Evaluation, AnObjectOfManyPurePiecesIsBroken) {
  Row row;
  row.Object(1, "shelf", ClassId::kUnknown);
  for (uint32_t piece = 1; piece <= 4; ++piece) row.Add(50, 1, piece, 0, 0);
  const std::vector<ObjectFinding> findings = Evaluate(row.truth, row.map, PaperClasses()).findings;
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].found, FoundAs::kBroken);
  EXPECT_EQ(findings[0].pieces, 4);
  EXPECT_DOUBLE_EQ(findings[0].covered, 0.25);
  EXPECT_DOUBLE_EQ(findings[0].purity, 1);
  EXPECT_FALSE(findings[0].shared_with);
}

TEST(EvaluationReport, HasTheFiguresInJsonAndInTheTable) {
  const Row row = MakeRow();
  const Evaluation evaluation = Evaluate(row.truth, row.map, PaperClasses());
  const std::string json = EvaluationJson(evaluation);
  EXPECT_THAT(json, ::testing::HasSubstr("\"discovery50_unknown\": 100.0"));
  EXPECT_THAT(json, ::testing::HasSubstr("\"real_confidence\": null"));
  const std::string table = EvaluationTable(evaluation);
  EXPECT_THAT(table, ::testing::HasSubstr("AP50, no ranking"));
  EXPECT_THAT(table, ::testing::HasSubstr("as ScanNet200"));
  EXPECT_THAT(table, ::testing::HasSubstr("100.0"));
  EXPECT_THAT(json, ::testing::HasSubstr("\"found\": \"missing\""));
  EXPECT_THAT(FindingsTable(evaluation),
              ::testing::HasSubstr("3 found, 0 broken, 0 swallowed, 1 missing"));
}

}  // namespace
}  // namespace vismap
