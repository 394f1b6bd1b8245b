#include "objects/change_log.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

using Blocks = std::vector<BlockIndex>;

TEST(ChangeLog, GivesTheBlocksThatChangedSinceARevision) {
  ChangeLog log;
  EXPECT_EQ(log.Since(-1), Blocks{});
  log.Record(1, {5, 0, 0});
  log.Record(2, {3, 0, 0});
  log.Record(3, {5, 0, 0});
  EXPECT_EQ(log.Since(0), (Blocks{{3, 0, 0}, {5, 0, 0}}));
  EXPECT_EQ(log.Since(2), (Blocks{{5, 0, 0}}));
  EXPECT_EQ(log.Since(3), Blocks{});
  log.Clear();
  EXPECT_EQ(log.Since(0), Blocks{});
}

TEST(ChangeLog, SaysWhenItHasForgottenSomeOfThem) {
  ChangeLog log(10);
  for (int i = 1; i <= 11; ++i) log.Record(i, {i, 0, 0});
  EXPECT_FALSE(log.Since(0));
  EXPECT_FALSE(log.Since(5)) << "the older half is forgotten";
  const auto newest = log.Since(9);
  ASSERT_TRUE(newest);
  EXPECT_EQ(*newest, (Blocks{{10, 0, 0}, {11, 0, 0}}));
}

}  // namespace
}  // namespace vismap
