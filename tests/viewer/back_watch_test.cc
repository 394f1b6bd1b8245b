#include "viewer/back_watch.h"

#include <gtest/gtest.h>

#include "viewer/map_copy.h"
#include "viewer/mesh_messages.h"

namespace vismap {
namespace {

using testing_support::SomeBlock;
using testing_support::SomeUpdate;

const FollowerPosition kOwn{"a", 50};

TEST(BackWatch, OlderRevisionsForFiveSecondsAreAMapThatWentBack) {
  BackWatch watch;
  EXPECT_FALSE(watch.Heard({"a", 20}, false, kOwn, 10));
  EXPECT_FALSE(watch.Heard({"a", 21}, false, kOwn, 14.9));
  EXPECT_TRUE(watch.Heard({"a", 21}, false, kOwn, 15));
  EXPECT_FALSE(watch.Heard({"a", 21}, false, kOwn, 15.1)) << "it was said once";
}

TEST(BackWatch, LateUpdatesAndSnapshotsForOthersAreNone) {
  BackWatch watch;
  EXPECT_FALSE(watch.Heard({"a", 20}, false, kOwn, 10));
  EXPECT_FALSE(watch.Heard({"a", 50}, false, kOwn, 12));
  EXPECT_FALSE(watch.Heard({"a", 20}, false, kOwn, 16));
  EXPECT_FALSE(watch.Heard({"b", 1}, false, kOwn, 18));
  for (double now = 20; now < 40; ++now) EXPECT_FALSE(watch.Heard({"a", 20}, true, kOwn, now));
}

TEST(BackWatch, ACopyThatNeedsASnapshotKeepsWhatItShowsUntilOneComes) {
  MapCopy copy({});
  copy.Apply(SomeUpdate("a", -1, 5, {SomeBlock(0, 0, 0, 1), SomeBlock(1, 0, 0, 2)}), 0);
  copy.ConsumeChanges();
  EXPECT_EQ(copy.Apply(SomeUpdate("a", -1, 2, {SomeBlock(0, 0, 0, 1)}), 0),
            FollowOutcome::kIgnored);
  copy.RequireSnapshot();
  EXPECT_EQ(copy.Summary().revision, 5);
  EXPECT_EQ(copy.Summary().blocks, 2u);
  EXPECT_FALSE(copy.Summary().in_sync);
  EXPECT_EQ(copy.position().revision, -1) << "it asks for the whole surface";
  EXPECT_EQ(copy.Apply(SomeUpdate("a", 1, 2, {}), 0), FollowOutcome::kNeedsSnapshot);
  EXPECT_EQ(copy.Apply(SomeUpdate("a", -1, 2, {SomeBlock(0, 0, 0, 1)}), 0),
            FollowOutcome::kApplied);
  EXPECT_EQ(copy.Summary().revision, 2);
  EXPECT_EQ(copy.Summary().blocks, 1u);
  const SurfaceChanges changes = copy.ConsumeChanges();
  EXPECT_FALSE(changes.reset);
  EXPECT_EQ(changes.blocks, (std::vector<BlockIndex>{{1, 0, 0}})) << "the other one is the same";
}

}  // namespace
}  // namespace vismap
