#include "hub/hold_budgets.h"

#include <algorithm>

namespace vismap {

namespace {
constexpr double kRefill = 0.1;  // seconds of budget that come back per second
}  // namespace

bool HoldBudgets::MayHold(const std::string& name) const {
  const auto used = used_.find(name);
  return used == used_.end() || used->second < limit_;
}

void HoldBudgets::Charge(const std::string& name, double seconds) { used_[name] += seconds; }

void HoldBudgets::Refill(double seconds) {
  for (auto& [name, used] : used_) used = std::max(0.0, used - kRefill * seconds);
  std::erase_if(used_, [](const auto& entry) { return entry.second == 0; });
}

}  // namespace vismap
