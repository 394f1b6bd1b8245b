#include "base/reason_counts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(ReasonCounts, CountsReasonsThatDifferInNumbersTogether) {
  ReasonCounts counts;
  EXPECT_EQ(LeftOutText(counts, 10), "0 of 10 frames were left out");
  counts.Add("there is no depth image");
  counts.Add("there is no pose at time 1.5");
  counts.Add("there is no pose at time -12.25");
  EXPECT_EQ(LeftOutText(counts, 10),
            "3 of 10 frames were left out: 2 x there is no pose at time 1.5; 1 x there is no depth "
            "image");
}

TEST(ReasonCounts, ShowsTheMostFrequentOnesAndIsBounded) {
  ReasonCounts counts;
  for (int length = 1; length <= 1000; ++length) counts.Add(std::string(length, 'a'));
  for (int i = 0; i < 3; ++i) counts.Add("aa");
  EXPECT_EQ(counts.total(), 1003);
  EXPECT_THAT(counts.Text(), HasSubstr("4 x aa; 1 x a; "));
  EXPECT_THAT(counts.Text(), HasSubstr("995 x other reasons"));
}

TEST(ReasonCounts, LongReasonsAreCut) {
  ReasonCounts counts;
  counts.Add(std::string(100000, 'x'));
  EXPECT_THAT(counts.Text(), SizeIs(404));
}

}  // namespace
}  // namespace vismap
