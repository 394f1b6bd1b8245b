#include "logs/map_history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

frame_commit_t Commit(const std::string& map, int64_t revision, int64_t utime,
                      int8_t status = frame_commit_t::STATUS_INTEGRATED) {
  frame_commit_t commit{};
  commit.map_id = map;
  commit.revision = revision;
  commit.utime = utime;
  commit.status = status;
  commit.reason = status == frame_commit_t::STATUS_INTEGRATED ? "" : "why";
  return commit;
}

std::vector<int64_t> Utimes(const MapHistory& history) {
  std::vector<int64_t> utimes;
  for (const frame_commit_t& commit : history.integrated) utimes.push_back(commit.utime);
  return utimes;
}

TEST(MapHistory, ListsFramesByRevision) {
  const MapHistory history =
      HistoryOfNewestMap({Commit("a", 1, 30), Commit("a", 1, 30), Commit("a", 2, 10),
                          Commit("a", 2, 30, frame_commit_t::STATUS_DUPLICATE),
                          Commit("a", 2, 20, frame_commit_t::STATUS_SKIPPED), Commit("a", 3, 40)});
  EXPECT_EQ(history.map_id, "a");
  EXPECT_THAT(Utimes(history), ElementsAre(30, 10, 40));
  EXPECT_THAT(history.remarks, IsEmpty());
  ASSERT_EQ(history.skipped.size(), 1u);
  EXPECT_EQ(history.skipped.begin()->first.utime, 20);
  EXPECT_EQ(history.skipped.begin()->second, "why");
}

TEST(MapHistory, StartsAgainWithANewMap) {
  const MapHistory history =
      HistoryOfNewestMap({Commit("a", 1, 10), Commit("a", 2, 20), Commit("b", 1, 10)});
  EXPECT_EQ(history.map_id, "b");
  EXPECT_THAT(Utimes(history), ElementsAre(10));
  EXPECT_THAT(history.remarks, IsEmpty());
}

// A server that crashed after its third frame and continued the map saved after the second.
TEST(MapHistory, ContinuesAcrossARestartOfTheServer) {
  const MapHistory history =
      HistoryOfNewestMap({Commit("a", 1, 10), Commit("a", 2, 20), Commit("a", 3, 30),
                          Commit("b", 3, 25), Commit("b", 4, 30)});
  EXPECT_THAT(Utimes(history), ElementsAre(10, 20, 25, 30));
  EXPECT_THAT(history.remarks, ElementsAre(HasSubstr("continues a saved map, probably a")));
}

TEST(MapHistory, ReportsMissingCommits) {
  EXPECT_THAT(HistoryOfNewestMap({Commit("a", 5, 50)}).remarks,
              ElementsAre(HasSubstr("revisions 1 to 4")));
  EXPECT_THAT(HistoryOfNewestMap({Commit("a", 1, 10), Commit("a", 3, 30)}).remarks,
              ElementsAre(HasSubstr("revisions 2 to 2")));
  EXPECT_EQ(HistoryOfNewestMap({}).map_id, "");
}

}  // namespace
}  // namespace vismap
