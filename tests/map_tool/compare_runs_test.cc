#include "map_tool/compare_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/log_builder.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

/// A run of three frames; `change` may modify its commits.
RunRecord RecordRun(const std::string& name,
                    const std::function<void(size_t, frame_commit_t*)>& change = nullptr,
                    const std::vector<int64_t>& order = {1000, 2000, 3000}) {
  LogBuilder builder;
  for (const int64_t utime : order) builder.Frame(utime).Detections(utime);
  for (size_t i = 0; i < order.size(); ++i) {
    frame_commit_t commit = builder.Committed(order[i], static_cast<int64_t>(i) + 1);
    if (change) change(i, &commit);
    builder.Add(kMapCommitChannel, commit, "map-server");
  }
  Result<RunRecord> record = ReadRunRecord(builder.Finish());
  EXPECT_TRUE(record) << record.error().message;
  record->name = name;
  return std::move(*record);
}

std::string Difference(const RunRecord& other) { return FirstDifference(RecordRun("A"), other); }

TEST(CompareRuns, EqualRunsDoNotDiffer) { EXPECT_EQ(Difference(RecordRun("B")), ""); }

TEST(CompareRuns, NamesTheFirstDifferentFrameAndTheDifference) {
  const auto with = [](const std::function<void(frame_commit_t*)>& change) {
    return Difference(RecordRun("B", [&](size_t i, frame_commit_t* commit) {
      if (i >= 1) change(commit);
    }));
  };
  EXPECT_THAT(with([](frame_commit_t* c) { c->digest = "other"; }),
              AllOf(HasSubstr("frame 2 of the map (camera 3, utime 2000)"),
                    HasSubstr("computed differently"), HasSubstr("digest2000 and other")));
  EXPECT_THAT(with([](frame_commit_t* c) { c->input_digest = "other"; }),
              AllOf(HasSubstr("utime 2000"), HasSubstr("the input differs"),
                    HasSubstr("input2000 and other")));
  EXPECT_THAT(with([](frame_commit_t* c) { c->had_detections = false; }),
              AllOf(HasSubstr("utime 2000"), HasSubstr("with detections in A, but without in B")));
}

TEST(CompareRuns, DistinguishesOrderFromMissingFrames) {
  EXPECT_THAT(Difference(RecordRun("B", nullptr, {1000, 3000, 2000})),
              AllOf(HasSubstr("frame 2 of the map"), HasSubstr("the order differs"),
                    HasSubstr("utime 3000 at this position")));
  EXPECT_THAT(Difference(RecordRun("B", nullptr, {1000, 3000})),
              AllOf(HasSubstr("utime 2000"), HasSubstr("never committed in B")));
  EXPECT_THAT(Difference(RecordRun("B", nullptr, {1000, 2000})),
              AllOf(HasSubstr("utime 3000"), HasSubstr("integrated in A, never committed in B")));
  EXPECT_THAT(FirstDifference(RecordRun("A", nullptr, {1000, 2000}), RecordRun("B")),
              AllOf(HasSubstr("utime 3000"), HasSubstr("integrated in B, never committed in A")));
  EXPECT_THAT(Difference(RecordRun("B",
                                   [](size_t i, frame_commit_t* commit) {
                                     if (i == 1) {
                                       commit->status = frame_commit_t::STATUS_SKIPPED;
                                       commit->reason = "it was broken";
                                     }
                                   })),
              AllOf(HasSubstr("utime 2000"), HasSubstr("skipped in B (it was broken)")));
}

TEST(CompareRuns, OrderOfArrivalIsNotADifference) {
  LogBuilder builder;
  builder.Frame(1000).Frame(2000).Detections(1000).Detections(2000).Frame(3000).Detections(3000);
  for (int64_t i = 1; i <= 3; ++i) builder.Commit(1000 * i, i);
  Result<RunRecord> other = ReadRunRecord(builder.Finish());
  ASSERT_TRUE(other);
  other->name = "B";
  const RunRecord run = RecordRun("A");
  EXPECT_EQ(FirstDifference(run, *other), "");
  EXPECT_THAT(CompareFacts(run, *other),
              Contains(AllOf(HasSubstr("a different order from message 2 on"),
                             HasSubstr("DETECTIONS of camera 3, utime 1000 in A"),
                             HasSubstr("RGBD_FRAME of camera 3, utime 2000 in B"),
                             HasSubstr("1 of 3 frames"))));
  EXPECT_THAT(CompareFacts(run, RecordRun("B")),
              Contains(HasSubstr("all 6 messages of the frames arrived in the same order")));
  EXPECT_THAT(CompareFacts(run, *other),
              Contains(HasSubstr("A: map map-1, revision 3, 3 frames integrated, 0 skipped")));
}

TEST(CompareRuns, NeedsCommits) {
  LogBuilder builder;
  EXPECT_THAT(ReadRunRecord(builder.Frame(1000).Finish()).error().message,
              HasSubstr("no MAP_COMMIT"));
}

}  // namespace
}  // namespace vismap
