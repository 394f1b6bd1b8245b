#include "pictures/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "pictures/html.h"
#include "pictures/report_parts.h"
#include "pictures/web_mesh.h"
#include "support/sphere_map.h"

namespace vismap {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kHostile[] = "<script>alert(1)</script>\"'&\x01";

TEST(Html, TextFromOutsideIsText) {
  EXPECT_EQ(Escaped("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_THAT(Escaped(kHostile), Not(HasSubstr("<")));
  EXPECT_EQ(EscapedLines("a\n<b>\n\nc"), "a\n&lt;b&gt;\n\nc\n");
  EXPECT_EQ(ScriptJson(R"({"a":"</script>"})"), R"({"a":"\u003c/script>"})");
  EXPECT_EQ(nlohmann::json::parse(ScriptJson(R"({"a":"</script>"})")).at("a"), "</script>");
}

// A flat square of n x n vertices 1 cm apart; the half with larger x belongs to instance 7.
Mesh Square(uint32_t n) {
  Mesh mesh;
  for (uint32_t i = 0; i < n * n; ++i) {
    MeshVertex vertex;
    vertex.position_W = {0.01F * static_cast<float>(i % n), 0.01F * static_cast<float>(i / n), 1};
    vertex.normal_W = Eigen::Vector3f::UnitZ();
    vertex.segment = SegmentLabel{3};
    vertex.color = {100, 150, 200};
    if (i % n >= n / 2) vertex.instance = InstanceId{7};
    mesh.vertices.push_back(vertex);
  }
  for (uint32_t v = 0; v + 1 < n; ++v) {
    for (uint32_t u = 0; u + 1 < n; ++u) {
      const uint32_t i = v * n + u;
      mesh.triangles.push_back({i, i + 1, i + n});
      mesh.triangles.push_back({i + 1, i + n + 1, i + n});
    }
  }
  return mesh;
}

double AreaOf(const Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](uint32_t i) { return mesh.vertices[i].position_W; };
    area += 0.5 * static_cast<double>((at(b) - at(a)).cross(at(c) - at(a)).norm());
  }
  return area;
}

TEST(WebMesh, CoarseMeshKeepsAreaOwnersAndColours) {
  const Mesh square = Square(200);
  const WebMesh same = CoarsenMesh(square, 50000);
  EXPECT_EQ(same.cell_m, 0);
  EXPECT_EQ(same.mesh.vertices.size(), square.vertices.size());
  EXPECT_EQ(same.mesh.triangles, square.triangles);
  const WebMesh coarse = CoarsenMesh(square, 2000);
  EXPECT_LE(coarse.mesh.vertices.size(), 2000u);
  EXPECT_GT(coarse.mesh.vertices.size(), 500u);
  EXPECT_GT(coarse.cell_m, 0.02);
  EXPECT_NEAR(AreaOf(coarse.mesh), AreaOf(square), 0.06 * AreaOf(square));
  for (const MeshVertex& vertex : coarse.mesh.vertices) {
    EXPECT_EQ(vertex.color, (Rgb8{100, 150, 200}));
    EXPECT_EQ(vertex.instance == InstanceId{7}, vertex.position_W.x() > 0.994F);
  }
}

TEST(WebMesh, MoreLabelsThanVerticesAreWantedEnd) {
  Mesh square = Square(20);
  for (size_t i = 0; i < square.vertices.size(); ++i)
    square.vertices[i].segment = SegmentLabel{static_cast<uint32_t>(i + 1)};
  EXPECT_EQ(CoarsenMesh(square, 100).mesh.vertices.size(), 400u);
}

TEST(WebMesh, WhatIsNotFiniteIsLeftOut) {
  Mesh mesh = Square(3);
  mesh.vertices[4].position_W.x() = std::numeric_limits<float>::quiet_NaN();
  mesh.vertices[8].position_W.y() = std::numeric_limits<float>::infinity();
  const WebMesh coarse = CoarsenMesh(mesh, 100);
  EXPECT_EQ(coarse.mesh.vertices.size(), 7u);
  for (const auto& triangle : coarse.mesh.triangles)
    for (const uint32_t corner : triangle) EXPECT_LT(corner, 7u);
  EXPECT_EQ(EncodeWebMesh({}, {}), "");
}

// The test of the script, tests/viewer/page/report.test.mjs, reads the same text.
TEST(WebMesh, BytesAreAsTheScriptReadsThem) {
  Mesh mesh;
  mesh.vertices.resize(3);
  mesh.vertices[1].position_W.x() = 1;
  mesh.vertices[2].position_W.y() = 2;
  for (uint8_t i = 0; i < 3; ++i) {
    const auto first = static_cast<uint8_t>(3 * i);
    mesh.vertices[i].color = {static_cast<uint8_t>(first + 1), static_cast<uint8_t>(first + 2),
                              static_cast<uint8_t>(first + 3)};
  }
  mesh.vertices[0].segment = SegmentLabel{3};
  mesh.vertices[1].instance = InstanceId{7};
  mesh.triangles = {{0, 1, 2}};
  std::vector<ObjectSummary> objects(2);
  objects[0].segments = {SegmentLabel{3}};
  objects[1].instance = InstanceId{7};
  EXPECT_EQ(EncodeWebMesh(mesh, objects),
            "AAAAAAAA//8AAAAAAAD//wAAAQIDBAUGBwgJAAAAAQD//wAAAAAAAAEAAAACAAAA");
  const auto header = nlohmann::json::parse(WebMeshHeader(mesh));
  EXPECT_EQ(header.at("vertices"), 3);
  EXPECT_EQ(header.at("triangles"), 1);
  EXPECT_EQ(header.at("high").at(1), 2);
}

ReportInput InputWith(const std::string& run_json) {
  ReportInput input;
  input.run_json = run_json;
  return input;
}

TEST(ReportParts, ARunThatIsMissingIsSaidWithItsReason) {
  ReportInput input;
  input.no_run = "The report.json beside the map is of another map.";
  EXPECT_THAT(StageTimesHtml(input), HasSubstr("is of another map"));
  EXPECT_THAT(FindingsHtml(input), HasSubstr("is of another map"));
}

TEST(ReportParts, RunsAndScoresFromFiles) {
  const std::string run =
      R"({"findings":["<b>poses</b>"],"stages_ms":{"total":{"median":12.5,"p95":20,"max":31},"<i>":{"median":"x"}}})";
  EXPECT_THAT(StageTimesHtml(InputWith(run)), HasSubstr("12.50"));
  EXPECT_THAT(StageTimesHtml(InputWith(run)), Not(HasSubstr("<i>")));
  EXPECT_THAT(FindingsHtml(InputWith(run)), HasSubstr("<li>&lt;b&gt;poses&lt;/b&gt;</li>"));
  for (const char* odd : {"", "[]", "{", R"({"stages_ms":3,"findings":{}})"}) {
    EXPECT_THAT(StageTimesHtml(InputWith(odd)),
                AnyOf(HasSubstr("are not known"), HasSubstr("has no times")));
    EXPECT_THAT(FindingsHtml(InputWith(odd)), Not(HasSubstr("<li>")));
  }
  const std::string scores =
      JsonTables(R"({"mAP50":81.25,"none":null,"deep":{"<u>":[1,{"b":"</td>"}]},"empty":[]})");
  EXPECT_THAT(scores, HasSubstr("81.2500"));
  EXPECT_THAT(scores, HasSubstr("&lt;u&gt;"));
  EXPECT_THAT(scores, HasSubstr("&lt;/td&gt;"));
  EXPECT_THAT(JsonTables("no"), HasSubstr("is no JSON object"));
  std::string deep;
  for (int i = 0; i < 60; ++i) deep += R"({"a":)";
  EXPECT_THAT(JsonTables(deep + "1" + std::string(60, '}')), HasSubstr("{&quot;a&quot;"));
}

ReportInput HostileInput() {
  ReportInput input;
  input.source = kHostile;
  input.no_scores = kHostile;
  input.no_script = "There is no script.";
  input.version = kHostile;
  ReportProcess process;
  process.source = process.process = process.host = process.version = process.state =
      process.message = kHostile;
  process.counters = {{kHostile, -5, 1}};
  process.timings = {{kHostile, 1, 2}};
  process.findings = {kHostile};
  input.processes = {process};
  input.channels = {{kHostile, 3, 100, 1}};
  return input;
}

LoadedMap Loaded(SemanticMap map, const std::string& text) {
  LoadedMap loaded{std::move(map), {}, text};
  loaded.metadata.map_id = loaded.metadata.config = loaded.metadata.created_by = text;
  loaded.metadata.trajectory.resize(2);
  loaded.metadata.trajectory[1].T_W_C.translation() = Eigen::Vector3d(0.5, 0, 0);
  return loaded;
}

std::string HtmlOf(const LoadedMap& loaded, const ReportInput& input) {
  int parts = 0;
  const std::string html =
      ReportHtml(loaded, {}, input, [&](const std::string&) { return ++parts > 0; });
  EXPECT_EQ(parts, 15);
  return html;
}

void ExpectAllParts(const std::string& html) {
  for (const char* id :
       {"summary", "map", "pictures", "objects", "discovered", "structure", "removed", "trajectory",
        "times", "space", "scores", "processes", "versions", "config"}) {
    EXPECT_THAT(html, HasSubstr("<section id=\"" + std::string(id) + "\">"));
    EXPECT_THAT(html, HasSubstr("href=\"#" + std::string(id) + "\""));
  }
  for (const char* outside : {"http://", "https://", "src=\"/", "url("})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
}

TEST(Report, NothingFromOutsideBecomesHtml) {
  const std::string html = HtmlOf(Loaded(testing_support::SphereMap(), kHostile), HostileInput());
  ExpectAllParts(html);
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, HasSubstr("There is no script."));
  EXPECT_THAT(html, HasSubstr("id=\"turntable\"><img src=\"data:image/webp;base64,"));
}

TEST(Report, EndsAtThePartAtWhichItIsStopped) {
  const LoadedMap loaded = Loaded(testing_support::SphereMap(), kHostile);
  for (const int last : {1, 4}) {
    int parts = 0;
    EXPECT_EQ(ReportHtml(loaded, {}, {}, [&](const std::string&) { return ++parts < last; }), "");
    EXPECT_EQ(parts, last);
  }
}

TEST(Report, ScriptAndSurfaceStandInThePage) {
  ReportInput input = HostileInput();
  input.script = "window.drawn = true;";
  const std::string html = HtmlOf(Loaded(testing_support::SphereMap(), kHostile), input);
  EXPECT_THAT(html, HasSubstr("<script>window.drawn = true;</script>"));
  const std::string before = "id=\"about\">";
  const size_t start = html.find(before) + before.size();
  const auto about =
      nlohmann::json::parse(html.substr(start, html.find("</script>", start) - start));
  EXPECT_GT(about.at("triangles"), 100);
  EXPECT_LE(about.at("vertices"), kMostReportVertices);
}

TEST(Report, EmptyMapSaysWhatIsMissingInEachPart) {
  SemanticMap empty(testing_support::kSphereGrid);
  LoadedMap loaded = Loaded(std::move(empty), "");
  loaded.metadata.trajectory.clear();
  ReportInput input;
  input.script = "0;";
  input.no_processes = "This is no log.";
  input.no_scores = "No truth was named.";
  const std::string html = HtmlOf(loaded, input);
  ExpectAllParts(html);
  for (const char* sentence :
       {"The map has no surface.", "The map has no objects.", "Nothing else was found.",
        "No object was seen to be removed.", "The map has no trajectory.",
        "Nothing is known of the space of this map.", "This is no log.", "No truth was named.",
        "The map does not say its config.", "The times of the stages are not known"})
    EXPECT_THAT(html, HasSubstr(sentence));
}

}  // namespace
}  // namespace vismap
