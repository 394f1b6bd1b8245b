#include "runtime/recent_timings.h"

#include <algorithm>
#include <vector>

namespace vismap {
namespace {

// The smallest value that `percent` of 100 values do not exceed. Changes the order.
double AtRank(std::vector<double>* values, size_t percent) {
  const size_t rank = (values->size() * percent + 99) / 100;  // counted from 1
  const auto place = values->begin() + static_cast<std::ptrdiff_t>(std::max<size_t>(rank, 1) - 1);
  std::nth_element(values->begin(), place, values->end());
  return *place;
}

}  // namespace

void RecentTimings::Add(double ms, double now) {
  if (entries_.size() >= kMost) entries_.pop_front();
  entries_.push_back({now, ms});
}

std::optional<RecentTimings::Percentiles> RecentTimings::At(double now) {
  while (!entries_.empty() && now - entries_.front().at > kWindow) entries_.pop_front();
  if (entries_.empty()) return std::nullopt;
  std::vector<double> values;
  values.reserve(entries_.size());
  for (const Entry& entry : entries_) values.push_back(entry.ms);
  return Percentiles{AtRank(&values, 50), AtRank(&values, 95)};
}

}  // namespace vismap
