#include "detector/pace.h"

#include <algorithm>
#include <cstdio>

namespace vismap {

std::optional<std::string> Pace::Summarize(double now) {
  const double seconds = std::max(now - since_, 1e-3);
  const auto looked = static_cast<double>(ms_.size());
  const double all = looked + static_cast<double>(skipped_);
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
  char sentence[128];
  std::snprintf(sentence, sizeof sentence,
                "looks at %.1f of %.1f frames per second, median %.0f ms each", looked / seconds,
                all / seconds, median);
  return sentence;
}

}  // namespace vismap
