#include "hub/hold_budgets.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

TEST(HoldBudgets, ANameHoldsForItsLimitAndGetsATenthOfTheTimeBack) {
  HoldBudgets budgets(60);
  EXPECT_TRUE(budgets.MayHold("map-server"));
  budgets.Charge("map-server", 60);
  EXPECT_FALSE(budgets.MayHold("map-server"));
  EXPECT_TRUE(budgets.MayHold("detector"));
  budgets.Refill(10);
  EXPECT_TRUE(budgets.MayHold("map-server"));
  budgets.Charge("map-server", 2);
  EXPECT_FALSE(budgets.MayHold("map-server"));
}

}  // namespace
}  // namespace vismap
