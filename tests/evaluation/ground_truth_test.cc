#include "evaluation/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "evaluation/class_list.h"
#include "evaluation/xml_labels.h"
#include "exports/ply.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A row of points; the segment of each, which ScanNet's meshes do not have.
std::vector<uint8_t> PlyOf(const std::vector<uint32_t>& labels) {
  Mesh mesh;
  for (const uint32_t label : labels) {
    mesh.vertices.emplace_back();
    mesh.vertices.back().position_W.x() = static_cast<float>(mesh.vertices.size());
    mesh.vertices.back().segment = SegmentLabel{label};
  }
  if (labels.size() >= 3) mesh.triangles.push_back({0, 1, 2});
  std::vector<uint8_t> bytes = EncodePly(mesh, {});
  const std::string from = "segment";  // SceneNN calls it label
  auto found = std::search(bytes.begin(), bytes.end(), from.begin(), from.end());
  bytes.erase(std::copy_n("label", 5, found), found + 7);
  return bytes;
}

TEST(SceneNnTruth, NamesLabelsByTheAnnotation) {
  const TempFolder folder;
  folder.Write("016/016.ply", PlyOf({5, 5, 7, 8, 0, 9, 11}));
  folder.Write("016/016.xml", R"(<?xml version="1.0"?>
<annotation>
  <!-- <label id="1" text="no"/> -->
  <label id="5" color="1 2 3" text="tv &amp; stand" nyu_class="television"/>
  <label id="7" text="wall" nyu_class="wall"/>
  <label id="8" text="" nyu_class="chair"/>
  <label id="9" text="lamp" nyu_class="lamp" />
  <label id="10" text="backpack" nyu_class="bag"></label>
</annotation>)");
  const auto truth = ReadGroundTruth(folder / "016");
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->format, "scenenn");
  EXPECT_THAT(truth->ObjectOfPoints(), ElementsAre(0, 0, 1, -1, -1, 2, -1));
  EXPECT_EQ(truth->points_W[2].x(), 3);
  EXPECT_EQ(truth->triangles.size(), 1u);
  ASSERT_EQ(truth->objects.size(), 4u);
  EXPECT_EQ(truth->objects[0].class_id, ClassId{72});
  EXPECT_TRUE(truth->objects[1].is_structure);
  EXPECT_EQ(truth->objects[2].class_id, ClassId::kUnknown);
  EXPECT_EQ(truth->objects[3].class_id, ClassId{27});
}

TEST(SceneNnTruth, TakesKindAndCocoIdOfExports) {
  const TempFolder folder;
  folder.Write("1/1.ply", PlyOf({1}));
  folder.Write("1/1.xml",
               R"(<label id="1" text="rug" kind="wall" nyu_class="rug" coco_id="0" frames="4"/>
                  <label id="2" text="x" kind="cup" nyu_class="otherprop" coco_id="47"/>
                  <label id="3" text="x" kind="table" nyu_class="desk" coco_id="67"/>)");
  const auto truth = ReadGroundTruth(folder / "1");
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_TRUE(truth->objects[0].is_structure);
  EXPECT_EQ(truth->objects[0].frames, 4);
  EXPECT_EQ(truth->objects[1].class_id, ClassId{47});
  EXPECT_EQ(truth->objects[2].class_id, ClassId{67});
}

TEST(SceneNnTruth, SaysWhatIsWrong) {
  const TempFolder folder;
  folder.Write("1/1.ply", PlyOf({1}));
  const auto message = [&] { return ReadGroundTruth(folder / "1").error().message; };
  EXPECT_THAT(message(), HasSubstr("1.xml"));
  folder.Write("1/1.xml", R"(<label id="one" text="x"/>)");
  EXPECT_THAT(message(), HasSubstr("found 'one'"));
  folder.Write("1/1.xml", R"(<label id="1" text="x"/><label id="1" text="y"/>)");
  EXPECT_THAT(message(), HasSubstr("two labels with the id 1"));
  folder.Write("1/1.xml", R"(<label id="1" text="x)");
  EXPECT_THAT(message(), HasSubstr("label element 1"));
  folder.Write("1/1.ply", "ply\n");
  EXPECT_THAT(message(), HasSubstr("1.ply"));
}

void WriteScanNet(const TempFolder& folder) {
  folder.Write("s/scene_vh_clean_2.ply", PlyOf({0, 0, 0, 0, 0}));
  folder.Write("s/scene_vh_clean_2.0.010000.segs.json", R"({"segIndices": [4, 4, 9, 2, 30]})");
  folder.Write("s/scene.aggregation.json", R"({"segGroups": [
    {"id": 0, "objectId": 0, "segments": [4, 9], "label": "armchair"},
    {"id": 1, "objectId": 1, "segments": [2], "label": "whiteboard"}]})");
}

TEST(ScanNetTruth, JoinsSegmentsToObjects) {
  const TempFolder folder;
  WriteScanNet(folder);
  const auto truth = ReadGroundTruth(folder / "s");
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->name, "scene");
  EXPECT_THAT(truth->labels, ElementsAre(1, 1, 1, 2, 0));
  EXPECT_EQ(truth->objects[0].class_id, ClassId{62});
  EXPECT_EQ(truth->objects[1].class_id, ClassId::kUnknown);
  EXPECT_EQ(truth->objects[1].name, "whiteboard");
}

TEST(ScanNetTruth, TakesClassesFromTheTable) {
  const TempFolder folder;
  WriteScanNet(folder);
  folder.Write("scannetv2-labels.combined.tsv",
               "id\traw_category\tcategory\tnyu40id\tnyu40class\n"
               "1\twhiteboard\twhiteboard\t30\ttelevision\n2\tarmchair\tchair\t5\twall\n");
  const auto truth = ReadGroundTruth(folder / "s");
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_TRUE(truth->objects[0].is_structure);
  EXPECT_EQ(truth->objects[1].class_id, ClassId{72});
}

TEST(ScanNetTruth, SaysWhatIsWrong) {
  const TempFolder folder;
  WriteScanNet(folder);
  const auto message = [&] { return ReadGroundTruth(folder / "s").error().message; };
  folder.Write("s/scene.aggregation.json", R"({"segGroups": [{"objectId": 0}]})");
  EXPECT_THAT(message(), HasSubstr("scene.aggregation.json: expected segGroups"));
  folder.Write("s/scene_vh_clean_2.0.010000.segs.json", R"({"segIndices": [4, 4]})");
  EXPECT_THAT(message(), HasSubstr("one for each of 5 vertices"));
  folder.Write("s/scene_vh_clean_2.0.010000.segs.json", R"({"segIndices": )");
  EXPECT_THAT(message(), HasSubstr("this is not JSON"));
}

TEST(GroundTruth, FolderWithoutAnyIsNamed) {
  const TempFolder folder;
  EXPECT_THAT(ReadGroundTruth(folder / "none").error().message, HasSubstr("/none: No such file"));
  EXPECT_THAT(ReadGroundTruth(folder.path()).error().message, HasSubstr("no ground truth"));
}

TEST(ClassList, IsOneOfTwoNamesOrCocoNames) {
  GroundTruth truth;
  truth.objects = {{.label = 1, .name = "cup", .class_id = ClassId{47}},
                   {.label = 2, .name = "lamp"},
                   {.label = 3, .name = "bag", .class_id = ClassId{27}}};
  EXPECT_EQ(ParseClassList("", truth)->size(), 9u);
  const auto scene = ParseClassList("scene", truth);
  ASSERT_EQ(scene->size(), 2u);
  EXPECT_EQ((*scene)[0].class_id, ClassId{27});
  EXPECT_EQ((*scene)[1].name, "cup");
  const auto listed = ParseClassList("dining table,bag", truth);
  ASSERT_EQ(listed->size(), 2u);
  EXPECT_EQ((*listed)[1].class_id, ClassId{27});
  EXPECT_THAT(ParseClassList("chair,desklamp", truth).error().message, HasSubstr("'desklamp'"));
}

}  // namespace
}  // namespace vismap
