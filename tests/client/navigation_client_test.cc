#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <new>
#include <thread>
#include <vismap/map_request_t.hpp>

#include "client/fake_exporter.h"
#include "client/navigation.h"
#include "client/navigation_parts.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::FakeExporter;
using testing_support::TreeMessage;
using testing_support::TwoRooms;

NavigationClientOptions OptionsOn(const ProcessBus& processes) {
  NavigationClientOptions options;
  options.url = processes.url();
  options.name = "planner under test";
  options.trees = {TreeKind::kClosed, TreeKind::kRaw};
  return options;
}

class NavigationClientTest : public ::testing::Test {
 protected:
  NavigationClientTest() : client(OptionsOn(processes)), exporter(&processes) {}

  void StartWithTree() {
    client.Start();
    exporter.SetMap(TwoRooms(true), 7);
    ASSERT_TRUE(exporter.LiveUntil([&] { return !client.Newest(TreeKind::kClosed).stale; }));
  }

  /// Lets the bus idle until the newest tree is stale; returns after how long [s].
  template <typename Meanwhile>
  double SecondsUntilStale(const Meanwhile& meanwhile) {
    const double start = MonotonicSeconds();
    EXPECT_TRUE(processes.SpinUntil([&] {
      meanwhile();
      return client.Newest(TreeKind::kClosed).stale;
    }));
    return MonotonicSeconds() - start;
  }

  ProcessBus processes;
  NavigationClient client;
  FakeExporter exporter;
};

TEST(NavigationThread, TellsOfAnExceptionInsteadOfEndingTheProgram) {
  std::atomic<bool> stopping{false};
  int turns = 0;
  const auto fails = [&] {
    if (++turns == 3) throw std::bad_alloc();
  };
  EXPECT_THAT(TurnUntil(stopping, fails),
              HasSubstr("the thread that handles messages has ended: std::bad_alloc"));
  EXPECT_EQ(turns, 3);
  EXPECT_THAT(TurnUntil(stopping, [] { throw 7; }), HasSubstr("has ended"));
  EXPECT_EQ(TurnUntil(stopping, [&] { stopping = true; }), "");
  ExporterNews news;
  news.failure = "it has ended";
  news.exporter_heard = news.server_heard = 10;
  EXPECT_EQ(news.WhySilent(2.8, 10), "it has ended");
  EXPECT_EQ(OutputState{}.WhyStale(GridName(), news, 2.8, 10), "it has ended");
}

TEST_F(NavigationClientTest, HandsOutTheNewestTreeAndNeverChangesOneThatItHandedOut) {
  EXPECT_THAT(client.Newest(TreeKind::kClosed).why,
              HasSubstr("nothing was heard of the octomap exporter yet"));
  StartWithTree();
  const FreeSpace first = client.Newest(TreeKind::kClosed);
  ASSERT_TRUE(first);
  EXPECT_EQ(first.why, "");
  EXPECT_LT(first.age_s, 3);
  EXPECT_EQ(first.tree->revision, 7);
  EXPECT_EQ(first.tree->unknown, octree_t::UNKNOWN_OCCUPIED);
  EXPECT_EQ(first.tree->data, exporter.closed.data);
  exporter.PublishTrees();  // again, as the exporter does while the map stands still
  exporter.SetMap(TwoRooms(false), 8);
  ASSERT_TRUE(exporter.LiveUntil([&] {
    const FreeSpace space = client.Newest(TreeKind::kClosed);
    EXPECT_TRUE(space.tree == first.tree || space.tree->revision == 8);
    return space.tree->revision == 8;
  }));
  EXPECT_EQ(first.tree->revision, 7);
  EXPECT_NE(client.Newest(TreeKind::kClosed).tree->data, first.tree->data);
  EXPECT_EQ(client.Newest(TreeKind::kRaw).tree->unknown, octree_t::UNKNOWN_ABSENT);
  EXPECT_THROW(client.Newest(TreeKind::kCoarse), std::invalid_argument);
  EXPECT_THROW(client.Handle(0), std::logic_error);
}

TEST_F(NavigationClientTest, SaysWithinThreeSecondsThatTheExporterIsDead) {
  StartWithTree();
  exporter.PublishTrees();
  exporter.PublishStatus();
  EXPECT_LT(SecondsUntilStale([] {}), 3);
  const FreeSpace space = client.Newest(TreeKind::kClosed);
  EXPECT_THAT(space.why, HasSubstr("the octomap exporter was not heard for "));
  EXPECT_EQ(space.tree->revision, 7);
  EXPECT_GT(space.age_s, 2);
  const FreeSpace refused = client.Newest(TreeKind::kClosed, 60);
  EXPECT_FALSE(refused);
  EXPECT_THAT(refused.why, HasSubstr("the octomap exporter was not heard for "));
  EXPECT_TRUE(exporter.LiveUntil([&] { return !client.Newest(TreeKind::kClosed).stale; }));
}

TEST_F(NavigationClientTest, SaysWithinThreeSecondsThatTheMapServerIsDeadThoughTreesStillCome) {
  StartWithTree();
  exporter.server_lives = false;
  EXPECT_LT(SecondsUntilStale([&] {
              exporter.PublishTrees();
              exporter.PublishStatus();
            }),
            3);
  EXPECT_THAT(client.Newest(TreeKind::kClosed).why, HasSubstr("the map server was not heard for "));
  EXPECT_GT(client.Newest(TreeKind::kClosed).age_s, 2);
  // A client that comes now does not take the tree for new, though it is new to it.
  NavigationClientOptions options = OptionsOn(processes);
  options.name = "late planner";
  NavigationClient late(options);
  late.Start();
  EXPECT_TRUE(exporter.LiveUntil([&] { return late.Newest(TreeKind::kClosed).age_s < 1e6; }));
  EXPECT_GT(late.Newest(TreeKind::kClosed).age_s, 2);
  EXPECT_TRUE(late.Newest(TreeKind::kClosed).stale);
}

TEST_F(NavigationClientTest, RefusesTreesThatAreOlderThanIsWanted) {
  StartWithTree();
  exporter.status.revision = 9;  // the map goes on, and no tree of it comes
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.Newest(TreeKind::kClosed).age_s > 1; }));
  EXPECT_FALSE(client.Newest(TreeKind::kClosed).stale);
  const FreeSpace refused = client.Newest(TreeKind::kClosed, 1);
  EXPECT_FALSE(refused);
  EXPECT_THAT(refused.why, HasSubstr("one of at most 1.0 s is wanted"));
  exporter.status.message = "there is no octree of the map: it is too large";
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.Newest(TreeKind::kClosed).stale; }));
  EXPECT_EQ(client.Newest(TreeKind::kClosed).why, exporter.status.message);
}

TEST_F(NavigationClientTest, SaysThatTheMapWasReplaced) {
  StartWithTree();
  exporter.status.map_id = "map b";
  ASSERT_TRUE(exporter.LiveUntil([&] { return client.Newest(TreeKind::kClosed).stale; }));
  EXPECT_THAT(client.Newest(TreeKind::kClosed).why, HasSubstr("the map was replaced"));
  exporter.SetMap(TwoRooms(true), 1);
  ASSERT_TRUE(exporter.LiveUntil([&] { return !client.Newest(TreeKind::kClosed).stale; }));
  EXPECT_EQ(client.Newest(TreeKind::kClosed).tree->map_id, "map b");
}

TEST_F(NavigationClientTest, NeverHandsOutEmptyDamagedOrRawTreesForClosedOnes) {
  StartWithTree();
  const octree_t good = exporter.closed;
  const std::shared_ptr<const octree_t> before = client.Newest(TreeKind::kClosed).tree;
  octree_t empty = TreeMessage(OccupancyMap(0.05), UnknownPolicy::kOccupied, 8);
  octree_t damaged = good;
  damaged.revision = 8;
  damaged.data.resize(damaged.data.size() / 2);
  damaged.data_size = static_cast<int32_t>(damaged.data.size());
  octree_t raw = exporter.raw;
  raw.revision = 8;
  for (const auto& [bad, words] : {std::pair(empty, "an empty tree has come on OCTOMAP"),
                                   std::pair(damaged, "octree_t of map 'map a', revision 8"),
                                   std::pair(raw, "planners would take unknown space for free")}) {
    exporter.closed = bad;
    ASSERT_TRUE(exporter.LiveUntil([&] { return client.Newest(TreeKind::kClosed).stale; }));
    EXPECT_THAT(client.Newest(TreeKind::kClosed).why, HasSubstr(words));
    EXPECT_EQ(client.Newest(TreeKind::kClosed).tree, before);
    exporter.closed = good;
    ASSERT_TRUE(exporter.LiveUntil([&] { return !client.Newest(TreeKind::kClosed).stale; }));
  }
}

TEST_F(NavigationClientTest, WaitsForAWhileAndThenSaysWhatIsMissing) {
  const FreeSpace none = client.WaitFor(TreeKind::kClosed, 0.2);  // without a thread
  EXPECT_FALSE(none);
  EXPECT_THAT(none.why, HasSubstr("nothing was heard of the octomap exporter yet"));
  exporter.SetMap(TwoRooms(true), 7);
  exporter.PublishStatus();
  const FreeSpace space = client.WaitFor(TreeKind::kClosed, kProcessDeadline);
  ASSERT_TRUE(space) << space.why;
  EXPECT_FALSE(space.stale);
  processes.StopHub();
  ASSERT_TRUE(processes.SpinUntil([&] {
    client.Handle(0.05);
    return client.Newest(TreeKind::kClosed).stale;
  }));
  EXPECT_THAT(client.Newest(TreeKind::kClosed).why, HasSubstr("no connection to the hub"));
}

TEST_F(NavigationClientTest, AsksAndRepeatsAndTellsTheReasonsOfARefusal) {
  client.Start();
  EXPECT_THAT(client.AskTree({}, 0.1).why,
              HasSubstr("no answer to the request 'octomap' within 0.1 s: nothing was heard"));
  std::vector<map_request_t> heard;
  processes.bus().Subscribe<map_request_t>(kMapRequestChannel, [&](const map_request_t& request) {
    heard.push_back(request);
    const auto same = std::count_if(heard.begin(), heard.end(), [&](const map_request_t& other) {
      return other.request_id == request.request_id;
    });
    if (same < 2) return;  // the first one is lost
    map_reply_t reply{};
    reply.requester = request.source;
    reply.request_id = request.request_id;
    reply.ok = request.resolution_m == 0.1;
    reply.message = "resolution_m: expected 0.1, found something else";
    const octree_t tree = TreeMessage(TwoRooms(true), UnknownPolicy::kOccupied, 3);
    reply.has_octree = true;
    reply.map_id = tree.map_id;
    reply.revision = tree.revision;
    reply.resolution_m = tree.resolution_m;
    reply.unknown = tree.unknown;
    reply.shell_m = tree.shell_m;
    reply.encoding = "bt";
    reply.payload = tree.data;
    reply.payload_size = tree.data_size;
    processes.bus().Publish(kMapReplyChannel, reply);
  });
  const auto ask = [&](double resolution) {
    FreeSpace answer;
    bool done = false;
    std::thread planner([&] {
      TreeRequest request;
      request.box = TreeRequest::Box{{0, 0, 0}, {1, 2, 3}};
      request.resolution_m = resolution;
      request.inflate_m = 0.25;
      request.without = "id=7";
      answer = client.AskTree(request, kProcessDeadline);
      done = true;
    });
    EXPECT_TRUE(processes.SpinUntil([&] { return heard.size() % 2 == 0 && !heard.empty(); }));
    planner.join();
    EXPECT_TRUE(done);
    return answer;
  };
  const FreeSpace tree = ask(0.1);
  ASSERT_TRUE(tree) << tree.why;
  EXPECT_EQ(tree.tree->revision, 3);
  EXPECT_EQ(tree.tree->resolution_m, 0.1);
  EXPECT_GT(tree.tree->n_nodes, 10);
  const map_request_t& request = heard.back();
  EXPECT_EQ(request.verb, "octomap");
  EXPECT_TRUE(request.has_bbx);
  EXPECT_EQ(request.bbx_max_W[2], 3);
  EXPECT_EQ(request.unknown, map_request_t::UNKNOWN_OCCUPIED);
  EXPECT_EQ(request.inflate_m, 0.25);
  EXPECT_EQ(request.without, "id=7");
  heard.clear();
  const FreeSpace refused = ask(0.07);
  EXPECT_FALSE(refused);
  EXPECT_EQ(refused.why, "resolution_m: expected 0.1, found something else");
}

TEST(SpaceDistances, TellObstaclesFromUnknownSpace) {
  const SpaceDistances distances(TreeMessage(TwoRooms(false), UnknownPolicy::kAbsent, 1));
  using Nearest = SpaceDistance::Nearest;
  // The pillar is from 0.8 to 1.2 m along x and y.
  const SpaceDistance pillar = distances.From({0.55, 0.55, 0.8});
  EXPECT_EQ(pillar.nearest, Nearest::kObstacle);
  EXPECT_NEAR(pillar.distance_m, 0.25 * std::sqrt(2), 1e-9);
  EXPECT_NEAR(pillar.away_W[0], -std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(pillar.away_W[2], 0, 1e-9);
  EXPECT_NEAR(distances.FromUnknown({0.5, 0.55, 0.8}).distance_m, 0.5, 1e-9);
  const SpaceDistance rim = distances.From({2.3, 0.8, 0.8});  // the space between the rooms
  EXPECT_EQ(rim.nearest, Nearest::kUnknown);
  EXPECT_NEAR(rim.distance_m, 0.3, 1e-9);
  EXPECT_NEAR(rim.away_W[0], 1, 1e-9);
  for (const std::array<double, 3>& unseen :
       {std::array{1.8, 0.8, 0.8}, std::array{0.5, -3.0, 0.8}})
    EXPECT_EQ(distances.From(unseen).distance_m, 0);
  EXPECT_EQ(distances.From({1, 1, 0.8}).distance_m, 0);
  EXPECT_EQ(SpaceDistances(TreeMessage(TwoRooms(true), UnknownPolicy::kAbsent, 1), 0.5)
                .FromObstacle({3, 0.3, 0.8})
                .nearest,
            Nearest::kNothing);
  const SpaceDistances closed(TreeMessage(TwoRooms(false), UnknownPolicy::kOccupied, 1));
  EXPECT_EQ(closed.From({2.3, 0.8, 0.8}).nearest, Nearest::kObstacle);
  EXPECT_NEAR(closed.From({2.3, 0.8, 0.8}).distance_m, 0.3, 1e-9);
  octree_t damaged = TreeMessage(TwoRooms(false), UnknownPolicy::kAbsent, 1);
  damaged.data.pop_back();
  EXPECT_THROW(SpaceDistances{damaged}, std::invalid_argument);
  EXPECT_THROW(SpaceDistances(TreeMessage(TwoRooms(false), UnknownPolicy::kAbsent, 1), -1),
               std::invalid_argument);
}

}  // namespace
}  // namespace vismap
