#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "support/mutations.h"
#include "wire/channels.h"
#include "wire/distance_follower.h"
#include "wire/envelope.h"
#include "wire/grid_message.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

GridMessage SmallGrid() {
  GridMessage message{5, 6, "m", 7, {}, {}};
  message.options.robot_height_m = 0.7;
  message.grid.resolution_m = 0.05;
  message.grid.origin_W = {-1.5, 0.25};
  message.grid.width = 3;
  message.grid.height = 2;
  message.grid.states = {CellState::kFree, CellState::kOccupied, CellState::kUnknown,
                         CellState::kFree, CellState::kFree,     CellState::kUnknown};
  message.grid.distances_m = {0.025F, 0, 0, 0.05F, 0.025F, 0};
  const float none = std::numeric_limits<float>::quiet_NaN();
  message.grid.floor_m = {0.01F, none, none, 0.02F, -0.01F, none};
  return message;
}

TEST(GridMessage, ComesBackAsItWasSent) {
  const GridMessage sent = SmallGrid();
  occupancy_grid_t message = Encode(sent);
  const Result<occupancy_grid_t> unpacked =
      Unpack<occupancy_grid_t>(Pack(message), kGridChannel.max_bytes);
  ASSERT_TRUE(unpacked);
  EXPECT_EQ(unpacked->basis, occupancy_grid_t::BASIS_FLOOR);
  const Result<GridMessage> read = Decode(*unpacked);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->utime, 5);
  EXPECT_EQ(read->published_utime, 6);
  EXPECT_EQ(read->revision, 7);
  EXPECT_EQ(read->options.robot_height_m, 0.7);
  EXPECT_EQ(read->grid.origin_W, sent.grid.origin_W);
  EXPECT_EQ(read->grid.states, sent.grid.states);
  EXPECT_EQ(read->grid.distances_m, sent.grid.distances_m);
  for (size_t i = 0; i < 6; ++i)
    EXPECT_TRUE(read->grid.floor_m[i] == sent.grid.floor_m[i] || std::isnan(sent.grid.floor_m[i]));
}

TEST(GridMessage, RefusesWhatNoGridHas) {
  const auto refusal = [](void (*spoil)(occupancy_grid_t*)) {
    occupancy_grid_t message = Encode(SmallGrid());
    spoil(&message);
    const Result<GridMessage> read = Decode(message);
    return read ? "" : read.error().message;
  };
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->width = 4; }), HasSubstr("6 cells"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->width = grid->height = -3; }),
              HasSubstr("6 cells"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->states[2] = 3; }),
              HasSubstr("states: expected 0, 1 or 2, found 3"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->distances_m[1] = NAN; }),
              HasSubstr("distances_m"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->floor_m[1] = INFINITY; }),
              HasSubstr("floor_m"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->resolution_m = 0; }),
              HasSubstr("resolution_m"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->origin_W[1] = NAN; }),
              HasSubstr("origin_W"));
  EXPECT_THAT(refusal([](occupancy_grid_t* grid) { grid->basis = 2; }), HasSubstr("basis"));
}

BlockDistances RandomDistances(TestRandom* random) {
  BlockDistances distances;
  for (auto* values : {&distances.obstacle, &distances.unknown}) {
    for (uint16_t& value : *values) value = static_cast<uint16_t>(random->Below(kBeyond + 1));
  }
  return distances;
}

DistanceUpdate SomeDistances(TestRandom* random) {
  DistanceUpdate update{{"m", 3, -1, true, 0, 1}, 5, 6, 0.05, 2, {}};
  for (int32_t i = -3; i < 3; ++i) update.blocks.emplace_back(BlockIndex{i, -i, 7}, std::nullopt);
  for (size_t i = 0; i < update.blocks.size(); i += 2)
    update.blocks[i].second = RandomDistances(random);
  return update;
}

TEST(DistanceUpdate, ComesBackBitForBit) {
  TestRandom random(1);
  const DistanceUpdate sent = SomeDistances(&random);
  distance_field_t message = Encode(sent);
  const Result<distance_field_t> unpacked =
      Unpack<distance_field_t>(Pack(message), kDistancesChannel.max_bytes);
  ASSERT_TRUE(unpacked);
  const Result<DistanceUpdate> read = Decode(*unpacked);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->head, sent.head);
  EXPECT_EQ(read->blocks, sent.blocks);
  EXPECT_EQ(read->leaf_m, 0.05);
  EXPECT_EQ(read->limit_m, 2);
  EXPECT_EQ(read->published_utime, 6);
}

TEST(DistanceUpdate, RefusesWhatNoFieldHas) {
  TestRandom random(2);
  const DistanceUpdate good = SomeDistances(&random);
  const auto refusal = [&](const std::function<void(distance_field_t*)>& spoil) {
    distance_field_t message = Encode(good);
    spoil(&message);
    const Result<DistanceUpdate> read = Decode(message);
    return read ? "" : read.error().message;
  };
  EXPECT_THAT(refusal([](distance_field_t* field) { field->revision = -1; }),
              HasSubstr("revision is negative"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->part = 1; }), HasSubstr("part 1 of 1"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->encoding = 2; }), HasSubstr("encoding"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->n_blocks = 1 << 20; }),
              HasSubstr("1048576 blocks"));
  EXPECT_THAT(refusal([](distance_field_t* field) { ++field->n_blocks; }),
              HasSubstr("the payload has 6 blocks"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->limit_m = NAN; }), HasSubstr("limit_m"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->resolution_m = -1; }),
              HasSubstr("resolution_m"));
  EXPECT_THAT(refusal([](distance_field_t* field) { field->payload.pop_back(); }),
              HasSubstr("distances: "));
  DistanceUpdate other = good;
  std::swap(other.blocks[1], other.blocks[2]);
  const auto refused = Decode(Encode(other));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("not in ascending order"));
  other = good;
  other.blocks[0].second->unknown[9] = 32768;
  EXPECT_THAT(Decode(Encode(other)).error().message, HasSubstr("above 32767"));
}

TEST(DistanceFollower, NoticesWhatItMissedAndWhatDoesNotFit) {
  TestRandom random(3);
  DistanceFollower follower;
  DistanceUpdate update = SomeDistances(&random);
  EXPECT_EQ(follower.Apply(update), FollowOutcome::kApplied);
  EXPECT_EQ(follower.SortedIndices().size(), 3U);
  EXPECT_EQ(follower.At(update.blocks[2].first), update.blocks[2].second);
  EXPECT_FALSE(follower.At(update.blocks[1].first));
  DistanceUpdate next{{"m", 4, 3, false, 0, 1}, 8, 9, 0.05, 2, {}};
  next.blocks.emplace_back(update.blocks[0].first, std::nullopt);
  EXPECT_EQ(follower.Apply(next), FollowOutcome::kApplied);
  EXPECT_FALSE(follower.At(update.blocks[0].first));
  EXPECT_EQ(follower.utime(), 8);
  const SharedDistanceBlocks shared = follower.Share();
  ASSERT_EQ(shared.size(), 2U);
  EXPECT_EQ(shared[0].first, update.blocks[2].first);
  EXPECT_EQ(*shared[0].second, *update.blocks[2].second);
  next.head = {"m", 7, 6, false, 0, 1};
  EXPECT_EQ(follower.Apply(next), FollowOutcome::kNeedsSnapshot);
  EXPECT_EQ(follower.gaps(), 1);
  EXPECT_EQ(follower.position().revision, 4);
  update.head.revision = 9;
  update.blocks[2].second->obstacle[3] ^= 1;
  EXPECT_EQ(follower.Apply(update), FollowOutcome::kApplied);
  EXPECT_NE(*shared[0].second, *follower.Share()[1].second) << "what was shared has changed";
  DistanceUpdate coarser{{"m", 10, 9, false, 0, 1}, 8, 9, 0.1, 2, {}};
  EXPECT_EQ(follower.Apply(coarser), FollowOutcome::kBroken);
  DistanceFollower small({.max_bytes = 3000});
  EXPECT_EQ(small.Apply(SomeDistances(&random)), FollowOutcome::kTooLarge);
}

}  // namespace
}  // namespace vismap
