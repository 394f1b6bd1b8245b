#include "adapter/output_report.h"

namespace vismap {

void OutputReport::Count(const std::string& counter) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counters_[counter];
}

void OutputReport::SetCounter(const std::string& counter, int64_t value) {
  const std::lock_guard<std::mutex> lock(mutex_);
  counters_[counter] = value;
}

void OutputReport::AddTiming(const std::string& stage, double ms) {
  constexpr size_t kMostTimings = 1000;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (timings_.size() < kMostTimings) timings_.emplace_back(stage, ms);
}

void OutputReport::SetFinding(const std::string& subject, const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex_);
  findings_[subject] = sentence;
}

void OutputReport::Fail(std::exception_ptr error) {
  const std::lock_guard<std::mutex> lock(mutex_);
  error_ = std::move(error);
}

void OutputReport::MoveTo(Status* status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  for (const auto& [counter, value] : counters_) status->SetCounter(counter, value);
  for (const auto& [stage, ms] : std::exchange(timings_, {})) status->AddTiming(stage, ms);
  for (const auto& [subject, sentence] : findings_)
    status->SetFinding(subject, sentence.empty() ? std::nullopt : std::optional(sentence));
}

std::vector<std::string> OutputReport::findings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> sentences;
  for (const auto& [subject, sentence] : findings_) {
    if (!sentence.empty()) sentences.push_back(sentence);
  }
  return sentences;
}

}  // namespace vismap
