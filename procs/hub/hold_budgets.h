#pragma once

#include <map>
#include <string>

namespace vismap {

/// Limits how long each critical process may make publishers wait. A process is known only by its
/// name, which any client can use, so there is one budget per name: it starts with `limit` seconds
/// and is refilled by 0.1 s per second. In the long run, publishers therefore wait at most one
/// second in eleven.
class HoldBudgets {
 public:
  explicit HoldBudgets(double limit) : limit_(limit) {}

  /// Whether publishers may wait for this process now.
  bool MayHold(const std::string& name) const;
  /// Subtracts the `seconds` for which publishers have waited for this process.
  void Charge(const std::string& name, double seconds);
  /// Refills all budgets after `seconds` have passed.
  void Refill(double seconds);

 private:
  double limit_;                        // [s]
  std::map<std::string, double> used_;  // used part of each budget [s]
};

}  // namespace vismap
