#include "base/option_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Part {
  double share = 0.5;
};
struct Options {
  int window_px = 5;
  double max_age_s = 10;
  Part part;
};

std::vector<std::string> ProblemsOf(const Options& options) {
  OptionCheck check;
  VISMAP_CHECK_ODD(check, options.window_px, 3, 63);
  VISMAP_CHECK_AT_LEAST(check, options.max_age_s, 0);
  VISMAP_CHECK_RANGE(check, options.part.share, 0, 0.75);
  check.Unless(options.max_age_s != 13, "max_age_s must not be 13");
  return std::move(check).problems();
}

TEST(OptionCheck, BoundsAreAllowed) {
  EXPECT_THAT(ProblemsOf({}), IsEmpty());
  EXPECT_THAT(ProblemsOf({3, 0, {0}}), IsEmpty());
  EXPECT_THAT(ProblemsOf({63, INFINITY, {0.75}}), IsEmpty());
}

TEST(OptionCheck, SentencesNameTheKeyAndTheBounds) {
  EXPECT_THAT(ProblemsOf({65, -1, {0.76}}),
              ElementsAre("window_px must be odd and in [3, 63]", "max_age_s must be at least 0",
                          "share must be in [0, 0.75]"));
  EXPECT_THAT(ProblemsOf({4, 13, {-0.1}}),
              ElementsAre("window_px must be odd and in [3, 63]", "share must be in [0, 0.75]",
                          "max_age_s must not be 13"));
}

TEST(OptionCheck, NotANumberIsAProblem) {
  EXPECT_THAT(ProblemsOf({5, NAN, {NAN}}),
              ElementsAre("max_age_s must be at least 0", "share must be in [0, 0.75]"));
}

TEST(OptionCheck, PartsGetAPrefix) {
  OptionCheck check;
  check.Add("part.", ProblemsOf({2, 1, {0}}));
  EXPECT_THAT(std::move(check).problems(),
              ElementsAre("part.window_px must be odd and in [3, 63]"));
}

}  // namespace
}  // namespace vismap
