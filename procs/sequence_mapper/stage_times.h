#pragma once

#include <map>
#include <string>
#include <vector>

namespace vismap {

/// Durations per stage of a run [ms], and the figures that reports give of them.
class StageTimes {
 public:
  void Add(const std::string& stage, double ms) { times_[stage].push_back(ms); }

  struct Figures {
    double median = 0;
    double p95 = 0;
    double max = 0;
  };
  /// Zeros for a stage that never ran.
  Figures Of(const std::string& stage) const;
  /// All stages by name.
  std::vector<std::string> stages() const;

 private:
  std::map<std::string, std::vector<double>> times_;
};

}  // namespace vismap
