#include <gtest/gtest.h>

#include <map>

#include "base/random.h"
#include "evaluation/evaluation.h"
#include "evaluation/scannet_script.h"

namespace vismap {
namespace {

using testing_support::ScanNetScript;

/// A row of random stretches of true objects and of a map's groups, where the group often begins
/// and ends with the object. Every third object is structure.
class RandomRow {
 public:
  explicit RandomRow(uint64_t seed) : dice_(seed) {
    truth_.format = "scenenn";
    map_.scores.emplace();
    while (truth_.points_W.size() < 4000) AddObject();
  }

  Evaluation Evaluated() const { return Evaluate(truth_, map_, PaperClasses()); }

  /// The same by the script. Predictions come in the order of the map: instances, then segments.
  ScanNetScript Script(bool with_scores) const {
    std::map<std::pair<bool, uint32_t>, int> number;
    for (const MeshVertex& v : map_.mesh.vertices) number.emplace(GroupOf(v), 0);
    std::vector<double> confidence;
    for (auto& [group, index] : number) {
      index = static_cast<int>(confidence.size());
      const bool is_instance = !group.first;
      confidence.push_back(!with_scores  ? 1
                           : is_instance ? map_.scores->at(InstanceId{group.second})
                                         : 0);
    }
    std::vector<int> objects, groups;
    int next = 0;
    std::map<uint32_t, int> object_number;
    for (const TrueObject& object : truth_.objects)
      object_number[object.label] = object.is_structure ? -1 : next++;
    for (size_t i = 0; i < truth_.labels.size(); ++i) {
      objects.push_back(truth_.labels[i] == 0 ? -1 : object_number.at(truth_.labels[i]));
      groups.push_back(number.at(GroupOf(map_.mesh.vertices[i])));
    }
    return {objects, groups, confidence, 100};
  }

 private:
  static std::pair<bool, uint32_t> GroupOf(const MeshVertex& v) {
    return v.instance == InstanceId::kNone ? std::pair(true, Raw(v.segment))
                                           : std::pair(false, Raw(v.instance));
  }
  uint32_t Draw(uint32_t below) { return static_cast<uint32_t>(dice_.Of(below)); }

  void AddObject() {
    const uint32_t label = Draw(5) == 0 ? 0 : static_cast<uint32_t>(truth_.objects.size() + 1);
    if (label != 0) {
      truth_.objects.push_back({.label = label,
                                .name = "thing",
                                .class_id = ClassId{static_cast<uint16_t>(62 * Draw(2))},
                                .is_structure = Draw(3) == 0});
    }
    const uint32_t points = 20 + Draw(300);
    // Of an object, a part keeps the group of the object before it.
    const uint32_t keeps = Draw(3) == 0 ? Draw(points) : 0;
    for (uint32_t i = 0; i < points; ++i) {
      if (i == keeps || (i > keeps && Draw(250) == 0)) NextGroup();
      AddPoint(label);
    }
  }

  void NextGroup() {
    const uint32_t id = ++last_group_;
    vertex_.segment = SegmentLabel{id};
    vertex_.instance = Draw(2) == 0 ? InstanceId{id} : InstanceId::kNone;
    vertex_.class_id = ClassId{static_cast<uint16_t>(62 * Draw(2))};
    if (vertex_.instance != InstanceId::kNone)
      (*map_.scores)[vertex_.instance] = 0.25 * (1 + Draw(4));
  }

  void AddPoint(uint32_t label) {
    if (last_group_ == 0) NextGroup();
    vertex_.position_W = {0.01f * static_cast<float>(truth_.points_W.size()), 0, 0};
    truth_.points_W.push_back(vertex_.position_W);
    truth_.labels.push_back(label);
    map_.mesh.vertices.push_back(vertex_);
  }

  Dice dice_;
  uint32_t last_group_ = 0;
  MeshVertex vertex_;
  GroundTruth truth_;
  EvaluatedMap map_;
};

TEST(AnyClassAp, EqualsScanNetsScriptOnRandomMaps) {
  double lowest = 1, highest = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const RandomRow row(seed);
    const Evaluation evaluation = row.Evaluated();
    const ScanNetScript constant = row.Script(false), scored = row.Script(true);
    EXPECT_NEAR(evaluation.any_class_ap.ap25.value(), constant.Ap(0.25), 1e-12) << seed;
    EXPECT_NEAR(evaluation.any_class_ap.ap50.value(), constant.Ap(0.5), 1e-12) << seed;
    EXPECT_NEAR(evaluation.any_class_ap.ap.value(), constant.MeanAp(), 1e-12) << seed;
    EXPECT_NEAR(evaluation.any_class_score_ap->ap25.value(), scored.Ap(0.25), 1e-12) << seed;
    EXPECT_NEAR(evaluation.any_class_score_ap->ap50.value(), scored.Ap(0.5), 1e-12) << seed;
    EXPECT_NEAR(evaluation.any_class_score_ap->ap.value(), scored.MeanAp(), 1e-12) << seed;
    lowest = std::min(lowest, constant.Ap(0.5));
    highest = std::max(highest, constant.Ap(0.5));
  }
  EXPECT_LT(lowest, 0.5) << "the rows are not all easy";
  EXPECT_GT(highest, 0.5) << "nor all hard";
}

}  // namespace
}  // namespace vismap
