#include "exports/objects_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "support/analytic_room.h"

namespace vismap {
namespace {

using namespace testing_support;

TEST(ObjectsJson, SameForAnyNumberOfThreads) {
  const SemanticMap map = AnalyticRoom();
  const auto text = [&](int threads) {
    const ThreadLimit limit(threads);
    return ObjectsJson("m", {}, SummarizeObjects(map), [](ClassId) { return "x"; });
  };
  EXPECT_EQ(text(1), text(4));
}

TEST(ObjectsJson, HasWhatScriptsRelyOn) {
  const SemanticMap map = AnalyticRoom();
  const auto objects = SummarizeObjects(map);
  const std::string text = ObjectsJson("k \"1\"", {{0, 0.6, 0.8}, "it is \"so\""}, objects,
                                       [](ClassId id) { return id == kChair ? "chair" : "\xff"; });
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("map_id"), "k \"1\"");
  EXPECT_EQ(json.at("up").at("direction"), nlohmann::json({0, 0.6, 0.8}));
  EXPECT_EQ(json.at("up").at("reason"), "it is \"so\"");
  ASSERT_EQ(json.at("objects").size(), 1u);
  ASSERT_EQ(json.at("discovered").size(), 1u);
  ASSERT_EQ(json.at("structure").size(), 1u);
  const auto& chair = json["objects"][0];
  EXPECT_EQ(chair.at("instance"), 5);
  EXPECT_EQ(chair.at("class"), 62);
  EXPECT_EQ(chair.at("class_name"), "chair");
  EXPECT_EQ(chair.at("segments"), nlohmann::json({2, 3}));
  EXPECT_EQ(chair.at("points"), objects[0].points);
  EXPECT_EQ(chair.at("frames"), 20);
  EXPECT_NEAR(chair.at("score").get<double>(), objects[0].score, 1e-6);
  EXPECT_EQ(chair.at("center").size(), 3u);
  EXPECT_EQ(chair.at("size").size(), 3u);
  EXPECT_EQ(chair.at("orientation").size(), 4u);
  EXPECT_EQ(json["discovered"][0].at("structure"), false);
  EXPECT_EQ(json["structure"][0].at("structure"), true);
  EXPECT_EQ(json["structure"][0].at("kind"), "floor");
  EXPECT_EQ(json["discovered"][0].at("instance"), 0);
}

TEST(ObjectsJson, EmptyListsAreLists) {
  EXPECT_EQ(ObjectsJson("m", {Eigen::Vector3d::UnitY(), "why"}, {}, {}),
            "{\"map_id\":\"m\",\n\"up\":{\"direction\":[0.0,1.0,0.0],\"reason\":\"why\"},"
            "\n\"objects\":[],\n\"discovered\":[],\n\"structure\":[],"
            "\n\"removed\":[]}\n");
}

}  // namespace
}  // namespace vismap
