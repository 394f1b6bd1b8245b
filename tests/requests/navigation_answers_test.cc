#include "requests/navigation_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "freespace/octree_builder.h"
#include "requests/request_argument.h"
#include "wire/distance_update.h"
#include "wire/envelope.h"
#include "wire/grid_message.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr double kCell = 0.01;

/// 1.6 m of free space along each axis from the origin, with a floor of 8 cm; a post of 8 cm stands
/// on it at x = y = 0.8 m.
OccupancyMap RoomWithPost() {
  OccupancyMap map(kCell);
  for (int i = 0; i < 20 * 20 * 20; ++i) {
    const bool occupied = i < 400 || (i % 20 == 10 && i / 20 % 20 == 10 && i < 400 * 8);
    map.Set({i % 20, i / 20 % 20, i / 400},
            BlockOccupancy(occupied ? CellState::kOccupied : CellState::kFree));
  }
  return map;
}

class NavigationAnswers : public ::testing::Test {
 protected:
  NavigationAnswers() {
    space_.voxels = &map_;
    space_.map_id = "m";
    space_.revision = 7;
    space_.utime = 9;
  }
  static map_request_t RequestWith(const std::string& argument) {
    map_request_t request{};
    request.unknown = map_request_t::UNKNOWN_DEFAULT;
    request.argument = argument;
    return request;
  }
  static map_request_t BoxRequest(const Eigen::Vector3d& min_W, const Eigen::Vector3d& max_W) {
    map_request_t request = RequestWith("");
    request.has_bbx = 1;
    Eigen::Map<Eigen::Vector3d>(request.bbx_min_W) = min_W;
    Eigen::Map<Eigen::Vector3d>(request.bbx_max_W) = max_W;
    return request;
  }
  static GroundGrid GridIn(const Result<Answer>& answer) {
    EXPECT_TRUE(answer) << answer.error().message;
    const auto message = Unpack<occupancy_grid_t>(answer->payload, size_t{1} << 26);
    EXPECT_TRUE(message);
    EXPECT_EQ(message->revision, 7);
    return Decode(*message)->grid;
  }
  static nlohmann::json JsonIn(const Result<Answer>& answer) {
    EXPECT_TRUE(answer) << answer.error().message;
    return nlohmann::json::parse(answer->payload);
  }

  OccupancyMap map_ = RoomWithPost();
  NavigationSpace space_;
};

TEST_F(NavigationAnswers, TheGridIsThatOfTheLibrary) {
  GroundGridOptions options;
  options.robot_height_m = 0.4;
  const GroundGrid expected = *MakeGroundGrid(map_, options, {});
  const GroundGrid grid = GridIn(AnswerGrid(space_, RequestWith("height=0.4")));
  EXPECT_EQ(grid.states, expected.states);
  EXPECT_EQ(grid.distances_m, expected.distances_m);
  EXPECT_EQ(grid.origin_W, expected.origin_W);
  options.band_min_m = 0.2;
  options.band_max_m = 0.3;
  options.resolution_m = 0.1;
  map_request_t request = RequestWith("band=0.2,0.3;height=0.4");
  request.resolution_m = 0.1;
  EXPECT_EQ(GridIn(AnswerGrid(space_, request)).states, MakeGroundGrid(map_, options, {})->states);
}

TEST_F(NavigationAnswers, ABoxCutsTheGridAtBlocks) {
  map_request_t request = BoxRequest({0.1, 0.1, -1}, {0.79, 0.4, 2});
  const GroundGrid grid = GridIn(AnswerGrid(space_, request));
  EXPECT_NEAR(grid.origin_W.x(), 0.05, 1e-9);
  EXPECT_NEAR(grid.origin_W.x() + grid.width * grid.resolution_m, 0.8, 1e-9);
  request = BoxRequest({5, 5, 0}, {6, 6, 1});
  EXPECT_THAT(AnswerGrid(space_, request).error().message, HasSubstr("nothing is known"));
}

TEST_F(NavigationAnswers, ClearanceIsThatOfTheWholeField) {
  OctreeBuilder builder = *OctreeBuilder::Make(kCell, {});
  builder.Update(map_, map_.SortedIndices());
  DistanceField field = *DistanceField::Make(builder.leaves().cell_size(), {2.0});
  field.Update(builder.leaves(), builder.leaves().SortedIndices());
  const std::vector<Eigen::Vector3d> points = {
      {0.4, 0.4, 0.5}, {0.72, 0.83, 0.3}, {1.55, 0.2, 1.5}, {0.82, 0.82, 0.3}, {-3, 0, 0}};
  map_request_t request =
      RequestWith("at=0.4,0.4,0.5;0.72,0.83,0.3;1.55,0.2,1.5;0.82,0.82,0.3;-3,0,0");
  for (const bool kept : {false, true}) {
    space_.leaves = kept ? &builder.leaves() : nullptr;
    space_.field = kept ? &field : nullptr;
    const nlohmann::json json = JsonIn(AnswerClearance(space_, request));
    ASSERT_THAT(json["points"], SizeIs(points.size()));
    for (size_t i = 0; i < points.size(); ++i) {
      const Clearance expected = field.From(points[i]);
      const nlohmann::json& point = json["points"][i];
      EXPECT_EQ(point["distance_m"], expected.distance_m) << i;
      EXPECT_EQ(point["nearest"], NameOf(expected.nearest)) << i;
      EXPECT_EQ(point["gradient"][1], expected.away_W.y()) << i;
      EXPECT_EQ(point["obstacle_m"], field.FromObstacle(points[i]).distance_m) << i;
      EXPECT_EQ(point["unknown_m"], field.FromUnknown(points[i]).distance_m) << i;
    }
    EXPECT_EQ(json["revision"], 7);
    EXPECT_EQ(json["limit_m"], 2);
  }
}

TEST_F(NavigationAnswers, DistancesInABoxAreThoseOfTheWholeField) {
  OctreeBuilder builder = *OctreeBuilder::Make(kCell, {});
  builder.Update(map_, map_.SortedIndices());
  DistanceField field = *DistanceField::Make(builder.leaves().cell_size(), {0.5});
  field.Update(builder.leaves(), builder.leaves().SortedIndices());
  map_request_t request = BoxRequest({0.41, 0.41, 0.41}, {0.79, 0.79, 0.79});
  request.argument = "limit=0.5";
  const Result<Answer> answer = AnswerDistances(space_, request);
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(answer->encoding, "distance_field_t");
  const auto update = Decode(*Unpack<distance_field_t>(answer->payload, size_t{1} << 26));
  ASSERT_TRUE(update) << update.error().message;
  ASSERT_THAT(update->blocks, SizeIs(1));
  EXPECT_EQ(update->blocks[0].first, (BlockIndex{1, 1, 1}));
  EXPECT_EQ(update->blocks[0].second, field.At({1, 1, 1}));
  EXPECT_EQ(update->limit_m, 0.5);
  EXPECT_TRUE(update->head.full);
}

TEST_F(NavigationAnswers, FrontiersOfABoxAreSomeOfAll) {
  map_request_t request = RequestWith("");
  request.inflate_m = 0.1;
  const nlohmann::json all = JsonIn(AnswerFrontiers(space_, request));
  ASSERT_GT(all["frontiers"].size(), 4U);
  map_request_t boxed = BoxRequest({0.9, -1, -1}, {3, 3, 3});
  boxed.inflate_m = 0.1;
  const nlohmann::json some = JsonIn(AnswerFrontiers(space_, boxed));
  auto expected = nlohmann::json::array();
  for (const auto& frontier : all["frontiers"]) {
    if (frontier["center_W"][0] >= 0.9) expected.push_back(frontier);
  }
  EXPECT_EQ(some["frontiers"], expected);
  EXPECT_LT(expected.size(), all["frontiers"].size());
}

TEST_F(NavigationAnswers, RefuseWhatIsImpossibleByOneSentence) {
  const auto grid = [&](const std::string& argument) {
    const Result<Answer> answer = AnswerGrid(space_, RequestWith(argument));
    return answer ? "" : answer.error().message;
  };
  EXPECT_THAT(grid("colour=red"),
              HasSubstr("keys height, step, slope, band, limit, found 'colour"));
  EXPECT_THAT(grid("height"), HasSubstr("expected key=value"));
  EXPECT_THAT(grid("height=1;height=2"), HasSubstr("the key height comes twice"));
  EXPECT_THAT(grid("height=nan"), HasSubstr("height: expected 1 finite number, found 'nan'"));
  EXPECT_THAT(grid("height=1,2"), HasSubstr("found '1,2'"));
  EXPECT_THAT(grid("height=-1"), HasSubstr("robot_height_m"));
  EXPECT_THAT(grid("band=1"), HasSubstr("band: expected 2 finite numbers"));
  EXPECT_THAT(grid("band=1,0.5"), HasSubstr("band: expected the lower height first"));
  const auto clearance = [&](const std::string& argument) {
    const Result<Answer> answer = AnswerClearance(space_, RequestWith(argument));
    return answer ? "" : answer.error().message;
  };
  EXPECT_THAT(clearance(""), HasSubstr("at: expected points at=x,y,z;x,y,z"));
  EXPECT_THAT(clearance("at=1,2"), HasSubstr("at: expected 3 finite numbers"));
  EXPECT_THAT(clearance("at=1,2,3;4,5"), HasSubstr("found '4,5'"));
  EXPECT_THAT(clearance("at=1,2,3;limit=1000"), HasSubstr("limit: expected more than 0"));
  EXPECT_THAT(clearance("at=1,2,3;limit=0"), HasSubstr("found 0 m"));
  map_request_t request = BoxRequest({1, 1, 1}, {0, 2, 2});
  EXPECT_FALSE(AnswerDistances(space_, request));
  EXPECT_FALSE(AnswerFrontiers(space_, request));
  EXPECT_FALSE(AnswerGrid(space_, request));
  EXPECT_THAT(AnswerDistances(space_, RequestWith("")).error().message, HasSubstr("need a box"));
  request = RequestWith("least=0");
  EXPECT_THAT(AnswerFrontiers(space_, request).error().message, HasSubstr("least: expected"));
  request = RequestWith("");
  request.inflate_m = NAN;
  EXPECT_THAT(AnswerFrontiers(space_, request).error().message, HasSubstr("inflate_m: expected"));
  EXPECT_THAT(AnswerGrid(space_, request).error().message, HasSubstr("inflate_m: expected 0"));
  request = RequestWith("");
  request.without = "id=7";
  EXPECT_THAT(AnswerGrid(space_, request).error().message, HasSubstr("without: "));
  request = RequestWith("");
  request.unknown = 7;
  EXPECT_THAT(AnswerGrid(space_, request).error().message, HasSubstr("unknown: expected"));
}

}  // namespace
}  // namespace vismap
