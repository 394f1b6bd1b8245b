// Grids and distances for planners.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "client/fake_exporter.h"
#include "client/navigation.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing_support::DistancesIn;
using testing_support::FakeExporter;
using testing_support::GridOf;
using testing_support::TreeMessage;
using testing_support::TwoRooms;

NavigationClientOptions OutputOptions(const ProcessBus& processes) {
  NavigationClientOptions options;
  options.url = processes.url();
  options.name = "planner of grids";
  options.trees = {};
  options.grid = true;
  options.distances = true;
  return options;
}

class NavigationOutputsTest : public ::testing::Test {
 protected:
  NavigationOutputsTest() : client(OutputOptions(processes)), exporter(&processes) {}

  void SetMap(bool open, int64_t revision) {
    exporter.SetMap(TwoRooms(open), revision);
    exporter.grid = GridOf(TwoRooms(open), revision, exporter.status.map_id);
    exporter.SetOutput("GRID", revision);
    exporter.SetOutput("DISTANCES", revision);
  }
  void StartWithBoth() {
    client.Start();
    exporter.AnswerDistances("");
    SetMap(true, 7);
    exporter.distances = DistancesIn(TwoRooms(true), 7, -1);
    ASSERT_TRUE(exporter.LiveUntil(
        [&] { return !client.NewestGrid().stale && !client.NewestDistances().stale; }));
  }
  double SecondsUntilBothAreStale(const std::function<void()>& meanwhile) {
    const double start = MonotonicSeconds();
    EXPECT_TRUE(processes.SpinUntil([&] {
      meanwhile();
      return client.NewestGrid().stale && client.NewestDistances().stale;
    }));
    return MonotonicSeconds() - start;
  }

  ProcessBus processes;
  NavigationClient client;
  FakeExporter exporter;
};

TEST_F(NavigationOutputsTest, HandsOutTheNewestGridAndNeverChangesOneThatItHandedOut) {
  EXPECT_THAT(client.NewestGrid().why, HasSubstr("nothing was heard of the octomap exporter yet"));
  StartWithBoth();
  const WheelGrid first = client.NewestGrid();
  ASSERT_TRUE(first);
  EXPECT_EQ(first.grid->revision, 7);
  EXPECT_EQ(first.grid->states, exporter.grid->states);
  EXPECT_LT(first.age_s, 3);
  EXPECT_EQ(first.why, "");
  SetMap(false, 8);
  ASSERT_TRUE(exporter.LiveUntil([&] {
    const WheelGrid now = client.NewestGrid();
    EXPECT_TRUE(now.grid == first.grid || now.grid->revision == 8);
    return now.grid->revision == 8;
  }));
  EXPECT_EQ(first.grid->revision, 7);
  EXPECT_NE(client.NewestGrid().grid->states, first.grid->states);
  EXPECT_THROW(client.Newest(TreeKind::kClosed), std::invalid_argument);
}

TEST_F(NavigationOutputsTest, SaysWithinThreeSecondsWhoIsDead) {
  StartWithBoth();
  exporter.PublishTrees();
  exporter.PublishStatus();
  EXPECT_LT(SecondsUntilBothAreStale([] {}), 3);
  EXPECT_THAT(client.NewestGrid().why, HasSubstr("the octomap exporter was not heard for "));
  EXPECT_THAT(client.NewestDistances().why, HasSubstr("the octomap exporter was not heard for "));
  EXPECT_EQ(client.NewestDistances().revision, 7);
  EXPECT_TRUE(client.NewestGrid());
  EXPECT_FALSE(client.NewestGrid(60));
  EXPECT_FALSE(client.NewestDistances(60));
  ASSERT_TRUE(exporter.LiveUntil([&] { return !client.NewestGrid().stale; }));
  exporter.server_lives = false;
  EXPECT_LT(SecondsUntilBothAreStale([&] {
              exporter.PublishTrees();
              exporter.PublishStatus();
            }),
            3);
  EXPECT_THAT(client.NewestGrid().why, HasSubstr("the map server was not heard for "));
  EXPECT_GT(client.NewestDistances().age_s, 2);
}

TEST_F(NavigationOutputsTest, RefusesDamagedGridsAndSaysWhyNoneComes) {
  StartWithBoth();
  const occupancy_grid_t good = *exporter.grid;
  exporter.grid->revision = 8;
  exporter.grid->states[0] = 9;
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.NewestGrid().stale; }));
  EXPECT_THAT(client.NewestGrid().why, HasSubstr("states: expected 0, 1 or 2, found 9"));
  EXPECT_EQ(client.NewestGrid().grid->revision, 7);
  exporter.grid = good;
  ASSERT_TRUE(exporter.LiveUntil([&] { return !client.NewestGrid().stale; }));
  // The exporter withholds the grid, and only that.
  exporter.SetOutput("GRID", -1);
  exporter.status.message = "GRID: z of the map does not point upward";
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.NewestGrid().stale; }));
  EXPECT_EQ(client.NewestGrid().why, exporter.status.message);
  EXPECT_FALSE(client.NewestDistances().stale) << client.NewestDistances().why;
  // A client that comes now hears why there is none.
  exporter.grid.reset();
  NavigationClientOptions options = OutputOptions(processes);
  options.name = "late planner of grids";
  NavigationClient late(options);
  late.Start();
  ASSERT_TRUE(exporter.LiveUntil([&] { return late.NewestDistances().age_s < 9; }));
  EXPECT_THAT(late.NewestGrid().why, HasSubstr("GRID: z of the map does not point upward"));
}

TEST_F(NavigationOutputsTest, FollowsDistancesAndAsksForWhatItMissed) {
  StartWithBoth();
  EXPECT_THAT(exporter.asked, ElementsAre(""));
  const KnownDistances first = client.NewestDistances();
  ASSERT_TRUE(first);
  EXPECT_EQ(first.revision, 7);
  const std::array<double, 3> door{1.8, 0.8, 0.8};
  EXPECT_GT(first.distances->FreeRadius(door), 0.1);
  // The space between the rooms becomes unknown: the next revision.
  SetMap(false, 8);
  exporter.distances = DistancesIn(TwoRooms(false), 8, 7);
  for (const auto& entry : DistancesIn(TwoRooms(true), 7, -1).blocks) {
    const auto known =
        std::any_of(exporter.distances->blocks.begin(), exporter.distances->blocks.end(),
                    [&](const auto& block) { return block.first == entry.first; });
    if (!known) exporter.distances->blocks.emplace_back(entry.first, std::nullopt);
  }
  std::sort(exporter.distances->blocks.begin(), exporter.distances->blocks.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  exporter.PublishDistances();
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.NewestDistances().revision == 8; }));
  EXPECT_EQ(client.NewestDistances().distances->FreeRadius(door), 0);
  EXPECT_GT(first.distances->FreeRadius(door), 0.1) << "what was handed out has changed";
  EXPECT_THAT(exporter.asked, ElementsAre(""));
  // Revision 9 is lost; the heartbeat of 9 tells.
  SetMap(true, 9);
  exporter.distances = DistancesIn(TwoRooms(true), 9, 8);
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.NewestDistances().revision == 9; }));
  EXPECT_THAT(exporter.asked, ElementsAre("", "map a@8"));
  EXPECT_GT(client.NewestDistances().distances->FreeRadius(door), 0.1);
}

TEST_F(NavigationOutputsTest, TellsTheReasonOfARefusalOfDistances) {
  client.Start();
  exporter.AnswerDistances(
      "distances are not kept up to date; set octomap_exporter.distance_limit_m");
  exporter.SetMap(TwoRooms(true), 7);
  ASSERT_TRUE(exporter.LiveUntil([&] {
    return client.NewestDistances().why.find("not kept up to date") != std::string::npos;
  }));
  EXPECT_FALSE(client.NewestDistances());
  EXPECT_THAT(client.NewestGrid().why,
              HasSubstr("the exporter sends it when octomap_exporter.grid_period_s is set"));
}

TEST_F(NavigationOutputsTest, DistancesAreThoseOfTheTreeAtItsCentresAndBoundsElsewhere) {
  StartWithBoth();
  const LeafDistances& found = *client.NewestDistances().distances;
  EXPECT_EQ(found.limit_m(), 1);
  ASSERT_EQ(found.leaf_m(), 0.1);
  const SpaceDistances exact(TreeMessage(TwoRooms(true), UnknownPolicy::kAbsent, 7), 1);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-0.3, 4.0), y(-0.3, 2.0);
  int free = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::array<double, 3> p{x(random), y(random), y(random)};
    std::array<double, 3> centre = p;
    for (double& ordinate : centre) ordinate = (std::floor(ordinate / 0.1) + 0.5) * 0.1;
    EXPECT_NEAR(found.ToUnknown(p), exact.FromUnknown(centre).distance_m, 1e-9);
    if (found.ToUnknown(p) > 0) {
      EXPECT_NEAR(found.ToObstacle(p), exact.FromObstacle(centre).distance_m, 1e-9);
    }
    const double distance = exact.From(p).distance_m;
    EXPECT_LE(found.FreeRadius(p), distance + 1e-9);
    EXPECT_GE(found.FreeRadius(p), distance - 1.74 * 0.1);
    free += found.FreeRadius(p) > 0.2;
  }
  EXPECT_GT(free, 300);
  for (const std::array<double, 3>& p :
       {std::array{1e18, 0.0, 0.0}, std::array{std::nan(""), 0.0, 0.0}}) {
    EXPECT_EQ(found.FreeRadius(p), 0);
    EXPECT_EQ(found.ToUnknown(p), 0);
  }
}

}  // namespace
}  // namespace vismap
