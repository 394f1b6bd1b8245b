#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "process/process_harness.h"

// vismap-evaluate, and the command vismap-map evaluate, which runs it.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr char kShortRoom[] = "synthetic:room?frames=16&width=160";
constexpr char kCoarse[] = "grid { voxel_size_m: 0.02 }\n";

/// Maps a sequence with voxels of 2 cm into `out` of the folder.
void MakeMap(const TempFolder& folder, const std::string& dataset, const std::string& frames) {
  folder.Write("coarse.txtpb", kCoarse);
  ChildProcess mapper("offline-mapper",
                      {"--dataset", dataset, "--max-frames", frames, "--config",
                       (folder / "coarse.txtpb").string(), "--out", (folder / "out").string()},
                      folder.path());
  ASSERT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
}

Json EvaluateMap(const TempFolder& folder, const std::string& truth, const std::string& map) {
  ChildProcess tool("evaluate", {"--gt", truth, "--map", (folder / map).string(), "--json"},
                    folder.path());
  EXPECT_EQ(tool.WaitForExit(), 0) << tool.StandardError();
  return Json::parse(tool.StandardOutput(), nullptr, false);
}

TEST(Evaluate, ErrorNamesAMissingGroundTruth) {
  const TempFolder folder;
  ChildProcess tool("map", {"evaluate", "--gt", (folder / "nothing").string(), "--map", "m.vismap"},
                    folder.path());
  EXPECT_EQ(tool.WaitForExit(), 3);
  EXPECT_THAT(tool.StandardError(), HasSubstr((folder / "nothing").string()));
}

TEST(Evaluate, ErrorNamesAMissingMapAndAnUnknownClass) {
  const TempFolder folder;
  ChildProcess tool("map", {"evaluate", "--gt", kShortRoom, "--map", "none.vismap"}, folder.path());
  EXPECT_EQ(tool.WaitForExit(), 3);
  EXPECT_THAT(tool.StandardError(), HasSubstr("none.vismap"));
  ChildProcess classes("map", {"evaluate", "--gt", kShortRoom, "--map", "m", "--classes", "chaise"},
                       folder.path());
  EXPECT_EQ(classes.WaitForExit(), 2);
  EXPECT_THAT(classes.StandardError(), HasSubstr("'chaise'"));
}

TEST(Evaluate, ErrorNamesAVertexWithoutAPlace) {
  const TempFolder folder;
  const std::array<float, 9> places{0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(),
                                    0, 0, 1, 0};
  const std::array<uint32_t, 3> triangle{0, 1, 2};
  folder.Write("nan.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
               "property float y\nproperty float z\nelement face 1\n"
               "property list uchar int vertex_indices\nend_header\n" +
                   std::string(reinterpret_cast<const char*>(places.data()), sizeof(places)) +
                   "\3" +
                   std::string(reinterpret_cast<const char*>(triangle.data()), sizeof(triangle)));
  ChildProcess tool("map", {"evaluate", "--gt", kShortRoom, "--map", (folder / "nan.ply").string()},
                    folder.path());
  EXPECT_EQ(tool.WaitForExit(), 3);
  EXPECT_THAT(tool.StandardError(), HasSubstr("nan.ply: vertex 1: expected finite coordinates"));
}

TEST(Evaluate, MapAndItsMeshHaveTheSameScores) {
  const TempFolder folder;
  MakeMap(folder, kShortRoom, "0");
  const Json map = EvaluateMap(folder, kShortRoom, "out/map.vismap");
  Json mesh = EvaluateMap(folder, kShortRoom, "out/mesh.ply");
  ASSERT_TRUE(map.is_object());
  EXPECT_GT(map["recall50_known"].get<double>(), 0);
  EXPECT_EQ(map["free_space"].size(), 2u);
  EXPECT_EQ(mesh["free_space"].size(), 0u);  // a mesh has no free space
  mesh["free_space"] = map["free_space"];
  EXPECT_EQ(map, mesh);
}

/// A Python interpreter with numpy and scipy; "" = there is none.
std::string FindScientificPython(const TempFolder& folder) {
  for (const char* program : {"/usr/bin/python3", "/usr/local/bin/python3"}) {
    if (!fs::exists(program)) continue;
    ChildProcess python(program, {"-c", "import numpy, scipy.spatial"}, folder.path());
    if (python.WaitForExit() == 0) return program;
  }
  return "";
}

/// All scores that both reports have agree within 1e-6. If two vertices have the same distance to a
/// point, the two programs may choose different ones (vismap: the lower index), which could change
/// a rounded score; on this map it does not.
void ExpectSameFigures(const Json& ours, const Json& theirs) {
  for (const auto& [key, value] : theirs.items()) {
    ASSERT_TRUE(ours.contains(key)) << key;
    if (value.is_object()) {
      ExpectSameFigures(ours[key], value);
    } else if (value.is_number()) {
      EXPECT_NEAR(ours[key].get<double>(), value.get<double>(), 1e-6) << key;
    } else {
      EXPECT_EQ(ours[key], value) << key;
    }
  }
}

TEST(Evaluate, AgreesWithTheIndependentScorer) {
  const char* data = std::getenv("VISMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set: no sequence and no scorer";
  const fs::path scorer = fs::path(data) / "../tools/score.py",
                 truth = fs::path(data) / "scenes/101";
  if (!fs::exists(scorer) || !fs::exists(truth))
    GTEST_SKIP() << "needs " << scorer << " and " << truth;
  const TempFolder folder;
  const std::string python = FindScientificPython(folder);
  if (python.empty()) GTEST_SKIP() << "no python3 with numpy and scipy";
  MakeMap(folder, truth.string(), "30");
  ChildProcess score(
      python,
      {scorer.string(), "--gt", truth.string(), "--mesh", (folder / "out/mesh.ply").string(),
       "--objects", (folder / "out/objects.json").string()},
      folder.path());
  ASSERT_EQ(score.WaitForExit(), 0) << score.StandardError();
  const Json theirs = Json::parse(score.StandardOutput(), nullptr, false);
  ASSERT_GE(theirs.size(), 15u);
  ExpectSameFigures(EvaluateMap(folder, truth.string(), "out/map.vismap"), theirs);
}

}  // namespace
}  // namespace vismap
