#include "base/reason_counts.h"

#include <algorithm>
#include <iterator>

namespace vismap {
namespace {

constexpr size_t kMaxReasons = 50, kMaxShownReasons = 5;
constexpr size_t kMaxLength = 400;  // characters of a reason

std::string WithoutNumbers(const std::string& reason) {
  std::string text;
  std::copy_if(reason.begin(), reason.end(), std::back_inserter(text), [](char c) {
    return (c < '0' || c > '9') && c != '.' && c != '-' && c != '+' && c != ' ';
  });
  return text;
}

}  // namespace

void ReasonCounts::Add(const std::string& reason) {
  ++total_;
  const std::string key = WithoutNumbers(reason.substr(0, kMaxLength));
  if (reasons_.size() >= kMaxReasons && !reasons_.contains(key)) return;
  Reason& known = reasons_[key];
  if (known.count++ == 0) known.example = reason.substr(0, kMaxLength);
}

// The most frequent reasons first.
std::vector<const ReasonCounts::Reason*> ReasonCounts::Sorted() const {
  std::vector<const Reason*> sorted;
  for (const auto& [key, reason] : reasons_) sorted.push_back(&reason);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Reason* a, const Reason* b) { return a->count > b->count; });
  return sorted;
}

ReasonCounts::Reason ReasonCounts::MostFrequent() const {
  const std::vector<const Reason*> sorted = Sorted();
  return sorted.empty() ? Reason{} : *sorted.front();
}

std::string ReasonCounts::Text() const {
  std::vector<const Reason*> sorted = Sorted();
  int64_t shown = 0;
  if (sorted.size() > kMaxShownReasons) sorted.resize(kMaxShownReasons);
  std::string text;
  for (const Reason* reason : sorted) {
    text += (text.empty() ? "" : "; ") + std::to_string(reason->count) + " x " + reason->example;
    shown += reason->count;
  }
  if (shown < total_) text += "; " + std::to_string(total_ - shown) + " x other reasons";
  return text;
}

std::string NoUsableFramesText(const ReasonCounts& left_out, int64_t all) {
  if (left_out.total() == 0) return "no usable frames";
  return "no usable frames (" + std::to_string(left_out.MostFrequent().count) + " of " +
         std::to_string(all) + ": " + left_out.MostFrequent().example + ")";
}

std::string LeftOutText(const ReasonCounts& left_out, int64_t all) {
  const std::string text =
      std::to_string(left_out.total()) + " of " + std::to_string(all) + " frames were left out";
  return left_out.total() == 0 ? text : text + ": " + left_out.Text();
}

}  // namespace vismap
