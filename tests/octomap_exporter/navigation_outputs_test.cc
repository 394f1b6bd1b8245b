#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "freespace/octree_builder.h"
#include "freespace/octree_cache.h"
#include "navigation/start_clearing.h"
#include "octomap_exporter/exporter_on_a_bus.h"
#include "wire/distance_follower.h"
#include "wire/grid_message.h"
#include "wire/object_list.h"

namespace vismap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

/// With the grids that it publishes of a room that changes.
class NavigationOutputs : public testing_support::ExporterOnABus {
 protected:
  NavigationOutputs() {
    config_.octomap_exporter.grid_period_s = 0.05;
    bus_->Subscribe<occupancy_grid_t>(
        kGridChannel, [this](const occupancy_grid_t& grid) { grids_.push_back(grid); });
    FillRoom();
  }

  bool HasGrid(int64_t revision) {
    return SpinUntil([&] { return !grids_.empty() && grids_.back().revision == revision; });
  }
  /// The field of the whole map, computed at once.
  DistanceField ExpectedField(double limit_m) {
    OctreeBuilder builder = *OctreeBuilder::Make(kVoxel, config_.octree);
    builder.Update(map_, map_.SortedIndices());
    DistanceField field = *DistanceField::Make(builder.leaves().cell_size(), {limit_m});
    field.Update(builder.leaves(), builder.leaves().SortedIndices());
    return field;
  }

  std::vector<occupancy_grid_t> grids_;
};

TEST_F(NavigationOutputs, PublishesTheGridOfEachStateAndRepeatsIt) {
  Start();
  SendMap();
  ASSERT_TRUE(HasGrid(1));
  const auto expect_grid = [&] {
    const Result<GridMessage> read = Decode(grids_.back());
    ASSERT_TRUE(read) << read.error().message;
    const GroundGrid expected = *MakeGroundGrid(map_, config_.ground_grid, {});
    EXPECT_EQ(read->grid.states, expected.states);
    EXPECT_EQ(read->grid.distances_m, expected.distances_m);
    EXPECT_EQ(read->utime, 1000 * revision_);
    EXPECT_THAT(read->grid.states, Contains(CellState::kFree));
  };
  expect_grid();
  Change({2, 2, 2}, CellState::kOccupied);
  ASSERT_TRUE(HasGrid(2));
  expect_grid();
  ASSERT_TRUE(SpinUntil([&] {
    return !navigation_.channels.empty() && navigation_.channels.back() == "GRID" &&
           navigation_.revisions.back() == 2;
  }));
  const occupancy_grid_t before = grids_.back();
  grids_.clear();
  ASSERT_TRUE(SpinUntil([&] { return !grids_.empty(); }, 2)) << "a reader that comes late";
  EXPECT_EQ(grids_.back().states, before.states);
  EXPECT_GT(grids_.back().published_utime, before.published_utime);
}

/// A list with one object, whose box is turned about x.
object_list_t ListWithBox(double degrees, const std::string& map_id = "m") {
  ObjectList list{1000, map_id, 1, {}};
  ObjectSummary object;
  object.segments = {SegmentLabel{3}};
  object.box.size = {1, 1, 1};
  object.box.R_W_B = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitX());
  list.objects.push_back(object);
  return Encode(list, [](ClassId) { return "thing"; });
}

TEST_F(NavigationOutputs, NoGridIsGivenOfAMapWhoseZIsNotUp) {
  Start();
  SendMap();
  ASSERT_TRUE(HasGrid(1));
  EXPECT_TRUE(Ask("grid", "").ok) << "nothing is known of the upward direction yet";
  bus_->Publish(kObjectsChannel, ListWithBox(90, "another map"));
  bus_->Publish(kObjectsChannel, ListWithBox(90));
  ASSERT_TRUE(SpinUntil([&] { return !status_.findings().empty(); }));
  EXPECT_THAT(status_.findings().front(),
              HasSubstr("(0.00, -1.00, 0.00) does, 90 degrees from z; publish poses in a world"));
  for (const char* argument : {"", "band=0.1,0.8"}) {
    EXPECT_FALSE(Ask("grid", argument).ok);
    EXPECT_EQ(replies_.back().message, status_.findings().front());
  }
  EXPECT_TRUE(Ask("frontiers", "").ok);
  grids_.clear();
  ASSERT_TRUE(SpinUntil([&] { return navigation_.message.starts_with("GRID: a grid needs z"); }));
  EXPECT_EQ(navigation_.channels.back(), "GRID");
  EXPECT_EQ(navigation_.revisions.back(), -1);
  Change({2, 2, 2}, CellState::kOccupied);
  EXPECT_FALSE(SpinUntil([&] { return !grids_.empty(); }, 2));
  bus_->Publish(kObjectsChannel, ListWithBox(10));
  ASSERT_TRUE(HasGrid(2));
  EXPECT_TRUE(status_.findings().empty());
  ASSERT_TRUE(SpinUntil([&] { return navigation_.message.empty(); }));
  EXPECT_EQ(navigation_.revisions.back(), 2);
  // Another map, of which nothing is known, is no longer judged by the objects of this one.
  bus_->Publish(kObjectsChannel, ListWithBox(90));
  ASSERT_TRUE(SpinUntil([&] { return !status_.findings().empty(); }));
  ++revision_;
  bus_->Publish(kMapDeltaChannel, Encode(MapUpdate{9000, "m2", revision_, -1, 0, 1,
                                                   testing_support::SnapshotOf(map_)}));
  ASSERT_TRUE(HasGrid(3));
}

TEST_F(NavigationOutputs, AFollowerHasTheDistancesOfTheWholeMapBitForBit) {
  config_.octomap_exporter.distance_limit_m = 0.6;
  DistanceFollower follower;
  bool deaf = false;
  bus_->Subscribe<distance_field_t>(kDistancesChannel, [&](const distance_field_t& message) {
    if (deaf) return;
    Result<DistanceUpdate> update = Decode(message);
    ASSERT_TRUE(update) << update.error().message;
    follower.Apply(std::move(*update), MonotonicSeconds());
  });
  Start();
  SendMap();
  for (int32_t step = 1; step < 12; ++step) {
    ASSERT_TRUE(HasGrid(revision_));
    if (!deaf) {
      if (follower.position().revision < revision_ - 1) {
        EXPECT_EQ(Ask("distances-delta", ToText(follower.position())).message,
                  "published on DISTANCES");
      }
      ASSERT_TRUE(SpinUntil([&] { return follower.position().revision == revision_; })) << step;
      const DistanceField expected = ExpectedField(0.6);
      ASSERT_EQ(follower.SortedIndices(), expected.SortedIndices()) << step;
      for (const BlockIndex& index : follower.SortedIndices())
        ASSERT_EQ(follower.At(index), expected.At(index)) << step;
      EXPECT_EQ(follower.limit_m(), 0.6);
    }
    deaf = step == 4 || step == 5;
    Change({step - 5, step % 3, step % 4 + 1},
           step % 5 == 0 ? CellState::kUnknown : CellState::kOccupied);
  }
  EXPECT_EQ(follower.gaps(), 1);
  ASSERT_TRUE(SpinUntil([&] {
    return !navigation_.channels.empty() && navigation_.channels.back() == "DISTANCES" &&
           navigation_.revisions.back() == revision_;
  }));
  EXPECT_EQ(navigation_.utimes.back(), 1000 * revision_);
  EXPECT_GT(navigation_.published_utimes.back(), navigation_.server_utime - 1000000);
}

TEST_F(NavigationOutputs, AnswersOfTheNewestMapAlsoBetweenTwoExports) {
  config_.octomap_exporter.period_s = 0;
  Start();
  EXPECT_THAT(Ask("clearance", "at=0,0,1").message, HasSubstr("no map yet"));
  SendMap();
  const auto distance = [&] {
    const map_reply_t reply = Ask("clearance", "at=0.08,0.08,0.72");
    EXPECT_TRUE(reply.ok) << reply.message;
    const std::string text(reply.payload.begin(), reply.payload.end());
    const size_t at = text.find("\"distance_m\":") + 13;
    return std::stod(text.substr(at));
  };
  EXPECT_NEAR(distance(), 0.54, 1e-9);
  Change({0, 0, 3}, CellState::kOccupied);
  EXPECT_EQ(distance(), ExpectedField(2).From({0.08, 0.08, 0.72}).distance_m);
  EXPECT_LT(distance(), 0.3);
  EXPECT_EQ(replies_.back().revision, 2);
  EXPECT_THAT(Ask("distances-delta", "").message, HasSubstr("octomap_exporter.distance_limit_m"));
  EXPECT_TRUE(Ask("frontiers", "").ok);
  EXPECT_THAT(Ask("grid", "high=1").message, HasSubstr("found 'high=1'"));
}

TEST_F(NavigationOutputs, WhereTheCameraWasIsFreeUnlessItWasSeenOccupied) {
  config_.octomap_exporter.clear_start_m = 0.2;
  config_.octomap_exporter.distance_limit_m = 0.6;
  // The space around the camera at (0.4, 0.4, 0.72) was not seen, but for a post.
  for (int i = 0; i < 27; ++i)
    map_.Set({i % 3 + 1, i / 3 % 3 + 1, i / 9 + 3}, BlockOccupancy(CellState::kUnknown));
  map_.Set({1, 1, 3}, BlockOccupancy(CellState::kOccupied));
  std::vector<octree_t> trees, raw;
  bus_->Subscribe<octree_t>(kOctomapChannel, [&](const octree_t& tree) { trees.push_back(tree); });
  bus_->Subscribe<octree_t>(kOctomapRawChannel, [&](const octree_t& tree) { raw.push_back(tree); });
  std::vector<std::string> arguments;
  bus_->Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    if (request.verb != "frames") return;
    arguments.push_back(request.argument);
    map_reply_t reply{};
    reply.requester = request.source;
    reply.request_id = request.request_id;
    reply.ok = true;
    reply.map_id = "m";
    const std::string json = "[[0.4, 0.4, 0.72]]";
    reply.payload.assign(json.begin(), json.end());
    reply.payload_size = static_cast<int32_t>(json.size());
    bus_->Publish(kMapReplyChannel, reply);
  });
  Start();
  SendMap();
  ASSERT_TRUE(SpinUntil([&] { return !raw.empty(); }));
  const octree_t tree = trees.back();
  ASSERT_GT(tree.n_assumed_free, 50);
  OctreeBuilder seen = *OctreeBuilder::Make(kVoxel, config_.octree);
  seen.Update(map_, map_.SortedIndices());
  OccupancyMap expected(seen.leaves().cell_size());
  for (const BlockIndex& index : seen.leaves().SortedIndices())
    expected.Set(index, seen.leaves().At(index));
  for (int32_t i = 0; i < tree.n_assumed_free; ++i) {
    const auto at = static_cast<size_t>(i);
    const VoxelIndex leaf{tree.assumed_free_x[at], tree.assumed_free_y[at],
                          tree.assumed_free_z[at]};
    ASSERT_EQ(seen.leaves().At(leaf), CellState::kUnknown);
    VoxelBits bit{};
    bit[static_cast<size_t>(OffsetInBlock(leaf)) / 64] = uint64_t{1} << (OffsetInBlock(leaf) % 64);
    expected.Set(BlockOf(leaf), WithFreeLeaves(expected.At(BlockOf(leaf)), bit));
  }
  EXPECT_EQ(expected.At(Eigen::Vector3d(0.4, 0.4, 0.72)), CellState::kFree);
  EXPECT_EQ(expected.At(Eigen::Vector3d(0.21, 0.21, 0.55)), CellState::kOccupied);
  OctreeOptions options = config_.octree;
  options.resolution_m = seen.resolution();
  options.unknown = UnknownPolicy::kOccupied;
  OctreeCache cache;
  cache.Update(expected, expected.SortedIndices());
  EXPECT_EQ(tree.data, cache.Encode(expected, options)->bytes);
  options.unknown = UnknownPolicy::kAbsent;
  EXPECT_EQ(raw.back().data, BuildOctree(map_, options)->bytes) << "of what was seen";
  EXPECT_EQ(raw.back().n_assumed_free, 0);
  ASSERT_TRUE(SpinUntil([&] { return navigation_.n_assumed_free == tree.n_assumed_free; }));
  EXPECT_THAT(Ask("clearance", "at=0.4,0.4,0.72").message, HasSubstr("1 point"));

  // What is seen there later counts.
  trees.clear();
  for (int i = 0; i < 26; ++i) Change({i % 3 + 1, i / 3 % 3 + 1, i / 9 + 3}, CellState::kFree);
  ASSERT_TRUE(SpinUntil([&] { return !trees.empty() && trees.back().revision == revision_; }));
  EXPECT_LT(trees.back().n_assumed_free, tree.n_assumed_free);
  EXPECT_THAT(arguments, Contains("positions=1"));
}

}  // namespace
}  // namespace vismap
