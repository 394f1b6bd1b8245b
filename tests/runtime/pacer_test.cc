#include "runtime/pacer.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

class PacedWork : public ::testing::Test {
 protected:
  /// Whether the work was done; it takes `seconds`.
  bool Run(double seconds = 0) {
    bool done = false;
    pacer_.RunIfDue([&] {
      done = true;
      now_ += seconds;
    });
    return done;
  }

  double now_ = 100;
  Pacer pacer_{2, [this] { return now_; }};
};

TEST_F(PacedWork, IsDoneAtOnceAndThenOncePerPeriod) {
  EXPECT_TRUE(Run());
  EXPECT_FALSE(Run());
  now_ += 1.9;
  EXPECT_FALSE(Run());
  now_ += 0.1;
  EXPECT_TRUE(Run());
  EXPECT_FALSE(Run());
}

TEST_F(PacedWork, ThatIsSlowTakesAFifthOfTheTimeAtMost) {
  EXPECT_TRUE(Run(3));
  now_ += 11.9;
  EXPECT_FALSE(Run());
  now_ += 0.1;
  EXPECT_TRUE(Run());
}

TEST_F(PacedWork, TakesASmallerShareWhenThatIsAllItMayTake) {
  const auto work = [this] { now_ += 1; };
  pacer_.RunIfDue(work, kShareWhenBehind);
  now_ += 18.9;
  EXPECT_FALSE(pacer_.due());
  now_ += 0.2;
  EXPECT_TRUE(pacer_.due());
}

TEST_F(PacedWork, WithoutAPeriodIsDoneEveryTimeWhenItTakesNoTime) {
  pacer_ = Pacer(0, [this] { return now_; });
  EXPECT_TRUE(Run());
  EXPECT_TRUE(Run());
}

TEST_F(PacedWork, IsDueOnePeriodAfterARestart) {
  EXPECT_TRUE(pacer_.due());
  pacer_.Restart();
  EXPECT_FALSE(pacer_.due());
  now_ += 1.5;
  pacer_.Restart();
  now_ += 1.5;
  EXPECT_FALSE(pacer_.due());
  now_ += 0.5;
  EXPECT_TRUE(pacer_.due());
}

}  // namespace
}  // namespace vismap
