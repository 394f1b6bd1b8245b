#include "sequence_mapper/stage_times.h"

#include <algorithm>

namespace vismap {

StageTimes::Figures StageTimes::Of(const std::string& stage) const {
  const auto found = times_.find(stage);
  if (found == times_.end() || found->second.empty()) return {};
  std::vector<double> sorted = found->second;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double fraction) {
    return sorted[static_cast<size_t>(fraction * static_cast<double>(sorted.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.95), sorted.back()};
}

std::vector<std::string> StageTimes::stages() const {
  std::vector<std::string> names;
  for (const auto& entry : times_) names.push_back(entry.first);
  return names;
}

}  // namespace vismap
