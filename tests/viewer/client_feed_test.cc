#include "viewer/client_feed.h"

#include <gmock/gmock.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "viewer/map_copy.h"
#include "viewer/mesh_messages.h"
#include "wire/mesh_follower.h"

namespace vismap {
namespace {

using testing::HasSubstr;
using testing_support::SomeBlock;
using testing_support::SomeUpdate;

// What a page makes of the messages that it gets.
struct PageModel {
  std::map<BlockIndex, std::pair<uint64_t, std::vector<uint8_t>>> blocks;
  std::vector<nlohmann::json> texts;
  int64_t binary_bytes = 0;

  void Take(const OutFrame& frame) {
    const std::vector<uint8_t>& bytes = *frame.bytes;
    if (frame.is_text) {
      texts.push_back(nlohmann::json::parse(bytes.begin(), bytes.end()));
      if (texts.back().value("reset", false)) blocks.clear();
      return;
    }
    binary_bytes += static_cast<int64_t>(bytes.size());
    if (bytes[0] != 1) return;
    int32_t index[3];
    uint32_t vertices = 0;
    uint64_t hash = 0;
    std::memcpy(index, bytes.data() + 4, sizeof index);
    std::memcpy(&vertices, bytes.data() + 24, sizeof vertices);
    std::memcpy(&hash, bytes.data() + 32, sizeof hash);
    const BlockIndex at{index[0], index[1], index[2]};
    blocks.erase(at);
    if (vertices > 0) blocks[at] = {hash, bytes};
  }
  uint64_t digest() const {
    uint64_t sum = 0;
    for (const auto& [index, block] : blocks) sum += block.first;
    return sum;
  }
  std::vector<std::string> Kinds() const {
    std::vector<std::string> kinds;
    for (const auto& text : texts) kinds.push_back(text["kind"]);
    return kinds;
  }
};

struct Feed {
  explicit Feed(MapCopy* map, const Board* board) : feed(map, board, "{\"kind\":\"hello\"}") {}
  // Takes at most `most` messages, and acknowledges all of them.
  int Drain(double now, int most = 1 << 30) {
    int taken = 0;
    for (; taken < most; ++taken) {
      feed.Allow(1e6);
      const auto frame = feed.Next(now);
      if (!frame) break;
      page.Take(*frame);
      const nlohmann::json ack{{"kind", "ack"}, {"bytes", page.binary_bytes}};
      EXPECT_TRUE(feed.OnText(ack.dump(), clock += 1));
    }
    return taken;
  }
  ClientFeed feed;
  PageModel page;
  double clock = 10000;  // of the acknowledgements, which must not come too fast [s]
};

class ClientFeedTest : public testing::Test {
 protected:
  void Apply(const mesh_delta_t& update) {
    ASSERT_EQ(map.Apply(update, 0), FollowOutcome::kApplied);
    const SurfaceChanges changes = map.ConsumeChanges();
    for (Feed* feed : feeds) feed->feed.OnChanges(changes);
    board.map = map.Summary();
  }
  // Random changes of a map of 6 x 6 x 6 blocks.
  void Change(int64_t revision) {
    std::map<BlockIndex, mesh_block_t> changed;
    for (int i = 0; i < 20; ++i) {
      const BlockIndex at{Random(6), Random(6), Random(6)};
      changed[at] = SomeBlock(at.x, at.y, at.z, Random(4), Random(1000));
    }
    std::vector<mesh_block_t> blocks;
    for (const auto& entry : changed) blocks.push_back(entry.second);
    Apply(SomeUpdate("a", revision == 1 ? -1 : revision - 1, revision, blocks));
  }
  int Random(int below) { return static_cast<int>(random() % static_cast<uint32_t>(below)); }

  std::mt19937 random{3};
  MapCopy map{FollowLimits{}};
  Board board;
  std::vector<Feed*> feeds;
};

TEST_F(ClientFeedTest, LargeTextsAreInsideTheBudgetAndLeaveHalfOfItToTheSurface) {
  const std::string large(300000, ' ');
  Feed feed(&map, &board);
  feeds = {&feed};
  board.Set(Board::Topic::kProcesses, "{\"kind\":\"processes\"}");
  board.Set(Board::Topic::kObjects, "{\"kind\":\"objects\"}" + large);
  while (const auto frame = feed.feed.Next(1)) feed.page.Take(*frame);
  EXPECT_THAT(feed.page.Kinds(), testing::ElementsAre("hello", "map", "processes"));
  feed.feed.Allow(1e5);
  while (const auto frame = feed.feed.Next(1)) feed.page.Take(*frame);
  EXPECT_THAT(feed.page.Kinds(), testing::ElementsAre("hello", "map", "processes", "objects"));
  // The list changes each time, and many blocks wait.
  int64_t text_bytes = 0;
  for (int revision = 1; revision <= 60; ++revision) {
    std::vector<mesh_block_t> blocks;
    for (int i = 0; i < 8; ++i) blocks.push_back(SomeBlock(i, revision, 0, 400, revision));
    Apply(SomeUpdate("a", revision == 1 ? -1 : revision - 1, revision, blocks));
    board.Set(Board::Topic::kObjects,
              "{\"kind\":\"objects\",\"n\":" + std::to_string(revision) + "}" + large);
    feed.feed.Allow(1e5);
    while (const auto frame = feed.feed.Next(1)) {
      if (frame->is_text) text_bytes += static_cast<int64_t>(frame->bytes->size());
      feed.page.Take(*frame);
      const nlohmann::json ack{{"kind", "ack"}, {"bytes", feed.page.binary_bytes}};
      ASSERT_TRUE(feed.feed.OnText(ack.dump(), feed.clock += 1));
    }
  }
  const int64_t all = text_bytes + feed.page.binary_bytes;
  EXPECT_LT(all, 60 * 1e5 + 4e5);
  EXPECT_GT(feed.page.binary_bytes, 0.4 * static_cast<double>(all));
  EXPECT_GT(text_bytes, 0.3 * static_cast<double>(all));
}

TEST_F(ClientFeedTest, BeginsWithHelloAndTheMap) {
  Feed feed(&map, &board);
  feed.Drain(1);
  EXPECT_THAT(feed.page.Kinds(), testing::ElementsAre("hello", "map"));
  EXPECT_TRUE(feed.page.texts[1]["reset"]);
  feed.Drain(1.5);
  EXPECT_EQ(feed.page.texts.size(), 2u);
  feed.Drain(2.1);
  EXPECT_EQ(feed.page.texts.size(), 3u);
  EXPECT_FALSE(feed.page.texts[2].contains("reset"));
}

TEST_F(ClientFeedTest, EarlyLateAndSlowPagesEndEqual) {
  Feed early(&map, &board), slow(&map, &board);
  feeds = {&early, &slow};
  for (int revision = 1; revision <= 200; ++revision) {
    Change(revision);
    early.Drain(revision);
    slow.Drain(revision, 3);
  }
  Feed late(&map, &board);
  late.Drain(300);
  slow.Drain(300);
  EXPECT_GT(late.page.blocks.size(), 50u);
  EXPECT_EQ(early.page.blocks, late.page.blocks);
  EXPECT_EQ(slow.page.blocks, late.page.blocks);
  EXPECT_EQ(late.page.digest(), map.Summary().digest);
  EXPECT_EQ(late.page.blocks.size(), map.Summary().blocks);
  EXPECT_EQ(late.feed.waiting(), 0u);
}

TEST_F(ClientFeedTest, SlowPageSkipsStatesThatWereReplaced) {
  Feed slow(&map, &board);
  feeds = {&slow};
  Apply(SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1, 1)}));
  for (int revision = 2; revision <= 100; ++revision)
    Apply(SomeUpdate("a", revision - 1, revision, {SomeBlock(0, 0, 0, 1, revision)}));
  EXPECT_EQ(slow.feed.waiting(), 1u);
  EXPECT_EQ(slow.Drain(1), 3);  // hello, map, one block
  EXPECT_EQ(slow.page.digest(), map.Summary().digest);
}

TEST_F(ClientFeedTest, PageThatNeverReadsTakesMemoryForTheNumberOfBlocksOnly) {
  Feed silent(&map, &board);
  feeds = {&silent};
  Change(1);
  size_t most = 0;
  for (int revision = 2; revision <= 500; ++revision) {
    Change(revision);
    silent.feed.AddNotice("info", "a sentence");
    board.Set(Board::Topic::kProcesses, std::string(1000, ' ') + std::to_string(revision));
    most = std::max(most, silent.feed.bytes());
  }
  EXPECT_LE(silent.feed.waiting(), 216u);
  EXPECT_LT(most, 40000u);
}

TEST_F(ClientFeedTest, PageThatDoesNotAcknowledgeGetsNoMoreSurface) {
  std::vector<mesh_block_t> blocks;
  for (int x = 0; x < 60; ++x) blocks.push_back(SomeBlock(x, 0, 0, 3000));
  Apply(SomeUpdate("a", -1, 1, blocks));
  Feed feed(&map, &board);
  PageModel page;
  for (int i = 0; i < 1000; ++i) {
    feed.feed.Allow(1e6);
    if (const auto frame = feed.feed.Next(0.1 * i)) page.Take(*frame);
  }
  EXPECT_GE(page.binary_bytes, FeedLimits{}.most_unacknowledged);
  EXPECT_LT(page.binary_bytes, FeedLimits{}.most_unacknowledged + 1000000);
  EXPECT_GT(page.texts.size(), 90u);  // it still learns what happens
  EXPECT_TRUE(feed.feed.OnText("{\"kind\":\"ack\",\"bytes\":9000000000}", 2000));
  EXPECT_EQ(feed.feed.unacknowledged(), 0);
  feed.Drain(2000);
  EXPECT_EQ(feed.feed.waiting(), 0u);
}

TEST_F(ClientFeedTest, SurfaceKeepsToTheBudget) {
  std::vector<mesh_block_t> blocks;
  for (int x = 0; x < 40; ++x) blocks.push_back(SomeBlock(x, 0, 0, 10));
  Apply(SomeUpdate("a", -1, 1, blocks));
  Feed feed(&map, &board);
  PageModel page;
  const auto size = static_cast<double>(map.Find({0, 0, 0})->bytes->size());
  for (int tick = 0; tick < 10; ++tick) {
    feed.feed.Allow(2 * size);
    while (const auto frame = feed.feed.Next(0)) page.Take(*frame);
  }
  EXPECT_EQ(page.blocks.size(), 20u);
}

TEST_F(ClientFeedTest, BlocksNearTheCentreComeFirst) {
  Apply(SomeUpdate("a", -1, 1,
                   {SomeBlock(0, 0, 0, 1), SomeBlock(5, 0, 0, 1), SomeBlock(9, 0, 0, 1)}));
  Feed feed(&map, &board);
  ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"want\",\"centre\":[4.9,0,0]}", 0));
  feed.Drain(0, 3);
  ASSERT_EQ(feed.page.blocks.size(), 1u);
  EXPECT_EQ(feed.page.blocks.begin()->first, (BlockIndex{9, 0, 0}));
}

TEST_F(ClientFeedTest, BlocksAreSortedAgainAtMostOncePerSecond) {
  Apply(SomeUpdate("a", -1, 1,
                   {SomeBlock(0, 0, 0, 1), SomeBlock(4, 0, 0, 1), SomeBlock(9, 0, 0, 1),
                    SomeBlock(20, 0, 0, 1)}));
  const auto want = [](Feed& feed, double x, double now) {
    const std::string text = "{\"kind\":\"want\",\"centre\":[" + std::to_string(x) + ",0,0]}";
    ASSERT_TRUE(feed.feed.OnText(text, now));
  };
  Feed feed(&map, &board);
  feed.Drain(10, 3);  // near the origin
  want(feed, 10.2, 10);
  feed.Drain(10, 1);
  EXPECT_TRUE(feed.page.blocks.contains({20, 0, 0}));
  want(feed, 0.2, 10.5);
  want(feed, 4.7, 10.6);
  want(feed, 0.2, 10.7);
  feed.Drain(10.9, 1);
  EXPECT_TRUE(feed.page.blocks.contains({9, 0, 0})) << "still sorted by the earlier centre";
}

TEST(Board, EqualTextIsNoChange) {
  Board board;
  board.Set(Board::Topic::kObjects, "one");
  const int64_t first = board.Get(Board::Topic::kObjects).number;
  board.Set(Board::Topic::kObjects, "one");
  EXPECT_EQ(board.Get(Board::Topic::kObjects).number, first);
  board.Set(Board::Topic::kObjects, "two");
  EXPECT_GT(board.Get(Board::Topic::kObjects).number, first);
}

TEST_F(ClientFeedTest, AnotherMapResetsThePage) {
  Feed feed(&map, &board);
  feeds = {&feed};
  Apply(SomeUpdate("a", -1, 5, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 1)}));
  feed.Drain(1);
  Apply(SomeUpdate("b", -1, 1, {SomeBlock(1, 0, 0, 2)}));
  feed.Drain(1.1);
  EXPECT_EQ(feed.page.blocks.size(), 1u);
  EXPECT_EQ(feed.page.digest(), map.Summary().digest);
}

TEST_F(ClientFeedTest, ResyncSendsEverythingAgainButNotAllTheTime) {
  Apply(SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 1)}));
  Feed feed(&map, &board);
  feed.Drain(1);
  feed.page.blocks.erase({0, 0, 0});  // lost by the page
  ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"resync\"}", 100));
  feed.Drain(100);
  EXPECT_EQ(feed.page.digest(), map.Summary().digest);
  ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"resync\"}", 101));
  EXPECT_EQ(feed.feed.waiting(), 0u);
}

TEST_F(ClientFeedTest, OnlyWantedPicturesAndOnlyTheNewest) {
  board.SetPicture(1, EncodePicture(1, "{}", {}));
  Feed feed(&map, &board);
  feed.Drain(0);
  EXPECT_EQ(feed.page.binary_bytes, 0);
  ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"want\",\"pictures\":[1]}", 0));
  board.SetPicture(1, EncodePicture(1, "{}", {}));
  EXPECT_EQ(feed.Drain(0.5), 1);
  EXPECT_EQ(feed.Drain(0.5), 0);
}

TEST_F(ClientFeedTest, PathComesInPartsAndAnewForAnotherMap) {
  Feed feed(&map, &board);
  for (int i = 0; i < 4500; ++i) board.AddPosition(2, {static_cast<float>(i), 0, 0});
  feed.Drain(0);
  EXPECT_THAT(feed.page.Kinds(),
              testing::ElementsAre("hello", "map", "trajectory", "trajectory", "trajectory"));
  EXPECT_EQ(feed.page.texts[4]["from"], 4000);
  EXPECT_EQ(feed.page.texts[4]["positions"].size(), 500u);
  board.RestartPaths();
  board.AddPosition(2, {1, 2, 3});
  feed.Drain(0.1);
  EXPECT_EQ(feed.page.texts.back()["from"], 0);
}

TEST_F(ClientFeedTest, WrongMessagesEndTheConnectionWithAReason) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "not JSON"},
      {"[]", "must be an object"},
      {"{\"kind\":5}", "must be an object with a kind"},
      {"{\"kind\":\"save\"}", "want, ack or resync"},
      {"{\"kind\":\"ack\"}", "whole number"},
      {"{\"kind\":\"ack\",\"bytes\":\"x\"}", "whole number"},
      {"{\"kind\":\"want\",\"mesh\":1}", "true or false"},
      {"{\"kind\":\"want\",\"pictures\":{}}", "at most 64"},
      {"{\"kind\":\"want\",\"pictures\":[0.5]}", "expected ids"},
      {"{\"kind\":\"want\",\"centre\":[1,2]}", "three numbers"},
      {"{\"kind\":\"want\",\"centre\":[1e300,0,0]}", "at most 1000000"}};
  for (const auto& [text, reason] : wrong) {
    Feed feed(&map, &board);
    const Result<void> handled = feed.feed.OnText(text, 0);
    ASSERT_FALSE(handled) << text;
    EXPECT_THAT(handled.error().message, HasSubstr(reason)) << text;
  }
}

TEST_F(ClientFeedTest, PageThatWantsBatchesGetsSeveralBlocksInOneMessage) {
  Apply(SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 2)}));
  Feed feed(&map, &board);
  ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"want\",\"batches\":true}", 0));
  feed.feed.Allow(1e6);
  ASSERT_TRUE(feed.feed.Next(0)->is_text);  // hello
  ASSERT_TRUE(feed.feed.Next(0)->is_text);  // map
  const std::optional<OutFrame> frame = feed.feed.Next(0);
  ASSERT_TRUE(frame);
  const std::vector<uint8_t>& bytes = *frame->bytes;
  const std::vector<uint8_t>& first = *map.Find({0, 0, 0})->bytes;
  const std::vector<uint8_t>& second = *map.Find({1, 0, 0})->bytes;
  ASSERT_EQ(bytes.size(), 8 + 4 + first.size() + 4 + second.size());
  EXPECT_THAT(std::vector<uint8_t>(bytes.begin(), bytes.begin() + 8),
              testing::ElementsAre(3, 0, 0, 0, 2, 0, 0, 0));
  EXPECT_TRUE(std::equal(first.begin(), first.end(), bytes.begin() + 12));
  EXPECT_TRUE(std::equal(second.rbegin(), second.rend(), bytes.rbegin()));
  EXPECT_EQ(feed.feed.unacknowledged(), static_cast<int64_t>(bytes.size()));
  EXPECT_FALSE(feed.feed.Next(0));
}

TEST_F(ClientFeedTest, MomentsAreForPagesOfLogsOnly) {
  Feed live(&map, &board);
  EXPECT_FALSE(live.feed.OnText("{\"kind\":\"moment\",\"frames\":3}", 0));
  ClientFeed log(&map, &board, "{}", {1e6, 1000, true});
  EXPECT_FALSE(log.TakeMoment());
  ASSERT_TRUE(log.OnText("{\"kind\":\"moment\",\"frames\":3}", 0));
  EXPECT_EQ(log.TakeMoment(), 3);
  EXPECT_FALSE(log.TakeMoment()) << "asked once";
  ASSERT_TRUE(log.OnText("{\"kind\":\"moment\",\"frames\":null}", 0));
  EXPECT_EQ(log.TakeMoment(), ClientFeed::kNewestMoment);
  for (const char* wrong : {"{\"kind\":\"moment\"}", "{\"kind\":\"moment\",\"frames\":\"3\"}",
                            "{\"kind\":\"moment\",\"frames\":1.5}"}) {
    const Result<void> handled = log.OnText(wrong, 0);
    ASSERT_FALSE(handled) << wrong;
    EXPECT_THAT(handled.error().message, HasSubstr("whole number"));
  }
}

TEST_F(ClientFeedTest, WhatAPageLacksReplacesWhatItLackedBefore) {
  Apply(SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 2)}));
  Feed feed(&map, &board);
  EXPECT_EQ(feed.feed.waiting(), 2u);
  feed.feed.SetLacking({{1, 0, 0}});
  EXPECT_EQ(feed.feed.waiting(), 1u);
  feed.Drain(0);
  EXPECT_EQ(feed.page.blocks.size(), 1u);
  EXPECT_TRUE(feed.page.blocks.contains({1, 0, 0}));
}

TEST_F(ClientFeedTest, FastPageMayAcknowledgeAsOftenAsItHasTo) {
  std::vector<mesh_block_t> blocks;
  for (int x = 0; x < 100; ++x) blocks.push_back(SomeBlock(x, 0, 0, 1500));
  Apply(SomeUpdate("a", -1, 1, blocks));
  Feed feed(&map, &board);
  int acknowledged = 0;
  for (;; ++acknowledged) {
    feed.feed.Allow(1e6);
    const auto frame = feed.feed.Next(0);
    if (!frame) break;
    feed.page.Take(*frame);
    const nlohmann::json ack{{"kind", "ack"}, {"bytes", feed.page.binary_bytes}};
    ASSERT_TRUE(feed.feed.OnText(ack.dump(), 0));
  }
  EXPECT_GT(acknowledged, ClientFeed::kMostMessagesPerSecond);
  const std::string same = "{\"kind\":\"ack\",\"bytes\":1}";
  int more = 0;
  while (feed.feed.OnText(same, 0) && more < 1000) ++more;
  EXPECT_LT(more, ClientFeed::kMostMessagesPerSecond);
}

TEST_F(ClientFeedTest, TooManyMessagesEndTheConnection) {
  Feed feed(&map, &board);
  for (int i = 0; i < ClientFeed::kMostMessagesPerSecond; ++i)
    ASSERT_TRUE(feed.feed.OnText("{\"kind\":\"resync\"}", 1));
  EXPECT_FALSE(feed.feed.OnText("{\"kind\":\"resync\"}", 1.5));
  EXPECT_TRUE(feed.feed.OnText("{\"kind\":\"resync\"}", 2.5));
}

TEST(MapCopy, EqualsAFollowerInDigestAndCounts) {
  MapCopy copy{FollowLimits{}};
  MeshFollower follower;
  const mesh_delta_t updates[] = {
      SomeUpdate("a", -1, 3, {SomeBlock(0, 0, 0, 2), SomeBlock(1, 0, 0, 4)}),
      SomeUpdate("a", 3, 4, {SomeBlock(0, 0, 0, 0), SomeBlock(2, 0, 0, 1)}),
      SomeUpdate("a", 9, 10, {}),
      SomeUpdate("a", -1, 11, {SomeBlock(2, 0, 0, 1), SomeBlock(3, 0, 0, 1)})};
  for (const mesh_delta_t& update : updates) {
    EXPECT_EQ(copy.Apply(update, 0), follower.Apply(update, 0));
    EXPECT_EQ(copy.Summary().mesh_digest, follower.Digest());
    EXPECT_EQ(copy.Summary().blocks, follower.block_count());
    EXPECT_EQ(copy.Summary().triangles, follower.triangle_count());
    EXPECT_EQ(copy.in_sync(), follower.in_sync());
  }
}

TEST(MapCopy, SnapshotOfTheSameMapChangesOnlyWhatDiffers) {
  MapCopy copy{FollowLimits{}};
  ASSERT_EQ(copy.Apply(SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 1)}), 0),
            FollowOutcome::kApplied);
  EXPECT_TRUE(copy.ConsumeChanges().reset);
  ASSERT_EQ(copy.Apply(SomeUpdate("a", -1, 2, {SomeBlock(1, 0, 0, 1), SomeBlock(2, 0, 0, 1)}), 0),
            FollowOutcome::kApplied);
  const SurfaceChanges changes = copy.ConsumeChanges();
  EXPECT_FALSE(changes.reset);
  EXPECT_THAT(changes.blocks, testing::ElementsAre(BlockIndex{0, 0, 0}, BlockIndex{2, 0, 0}));
}

TEST(MapCopy, KnowsTheSizeOfBlocksAlsoWhenThePartThatComesLastIsEmpty) {
  MapCopy copy{FollowLimits{}};
  mesh_delta_t first = SomeUpdate("a", -1, 1, {SomeBlock(0, 0, 0, 1)});
  mesh_delta_t last = SomeUpdate("a", -1, 1, {});
  first.parts = last.parts = 2;
  last.part = 1;
  EXPECT_EQ(copy.Apply(first, 0), FollowOutcome::kWaiting);
  EXPECT_EQ(copy.Apply(last, 0), FollowOutcome::kApplied);
  EXPECT_EQ(copy.block_edge_m(), 0.5);
}

TEST(MapCopy, SurfaceAboveTheLimitIsDropped) {
  MapCopy copy{FollowLimits{.max_bytes = 20000}};
  std::vector<mesh_block_t> blocks;
  for (int x = 0; x < 30; ++x) blocks.push_back(SomeBlock(x, 0, 0, 10));
  EXPECT_EQ(copy.Apply(SomeUpdate("a", -1, 1, blocks), 0), FollowOutcome::kTooLarge);
  EXPECT_LT(copy.bytes(), 20000u);
  EXPECT_EQ(copy.Summary().blocks, 0u);
}

TEST(MapCopy, InconsistentUpdateIsRefused) {
  MapCopy copy{FollowLimits{}};
  mesh_block_t block = SomeBlock(0, 0, 0, 1);
  block.a[0] = 3;
  EXPECT_EQ(copy.Apply(SomeUpdate("a", -1, 1, {block}), 0), FollowOutcome::kBroken);
}

}  // namespace
}  // namespace vismap
