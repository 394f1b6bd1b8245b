#include "detector/pace.h"

#include <algorithm>
#include <cstdio>

#include "base/format.h"

namespace vismap {

std::optional<std::string> Pace::Summarize(double now) {
  const double seconds = std::max(now - since_, 1e-3);
  const auto processed = static_cast<double>(ms_.size());
  const double all = processed + static_cast<double>(skipped_);
  double median = 0;
  if (!ms_.empty()) {
    const auto middle = ms_.begin() + static_cast<std::ptrdiff_t>(ms_.size() / 2);
    std::nth_element(ms_.begin(), middle, ms_.end());
    median = *middle;
  }
  since_ = now;
  ms_.clear();
  skipped_ = 0;
  if (all == 0) return std::nullopt;
  char rates[64];
  std::snprintf(rates, sizeof rates, "runs on %.1f of %.1f frames per second", processed / seconds,
                all / seconds);
  if (processed == 0) return rates;
  return std::string(rates) + ", " + FormatDuration(median * 1e-3) + " per frame (median)";
}

}  // namespace vismap
