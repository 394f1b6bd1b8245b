#pragma once

#include <map>
#include <string>

namespace vismap {

/// How long each critical process may still make publishers wait. A process is known by its name
/// only, which any client can claim, so the time in total is bounded for each name: `limit`
/// seconds, which come back at a tenth of the speed of time. In the long run, publishers therefore
/// wait at most one second in eleven.
class HoldBudgets {
 public:
  explicit HoldBudgets(double limit) : limit_(limit) {}

  /// Whether publishers may wait for this process now.
  bool MayHold(const std::string& name) const;
  /// `seconds` have passed, in which publishers have waited for this process.
  void Charge(const std::string& name, double seconds);
  /// `seconds` have passed: every budget grows.
  void Refill(double seconds);

 private:
  double limit_;                        // [s]
  std::map<std::string, double> used_;  // [s], of names that have used some
};

}  // namespace vismap
