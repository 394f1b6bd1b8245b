#include "runtime/status.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/status_message.h"

namespace vismap {
namespace {

constexpr size_t kMaxTimings = 10000;  // per stage and STATUS
constexpr size_t kMaxFindings = 16;    // of a STATUS, which has a largest size
constexpr size_t kMaxFindingLength = 1500;
constexpr size_t kMaxSubjects = 64;  // of findings; names from the bus may be part of a subject

double Median(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

void AddChannel(process_status_t* message, const std::string& channel,
                const ChannelCounters& counters) {
  const std::pair<const char*, int64_t> figures[] = {{".received", counters.received},
                                                     {".received_bytes", counters.received_bytes},
                                                     {".rejected", counters.rejected},
                                                     {".lost", counters.lost},
                                                     {".superseded", counters.superseded},
                                                     {".published", counters.published},
                                                     {".published_bytes", counters.published_bytes},
                                                     {".unsent", counters.unsent}};
  for (const auto& [figure, value] : figures) {
    if (value != 0) AddCounter(message, channel + figure, value);
  }
}

}  // namespace

const char* StateName(ProcessState state) {
  switch (state) {
    case ProcessState::kStarting:
      return "starting";
    case ProcessState::kReady:
      return "ready";
    case ProcessState::kWaiting:
      return "waiting";
    case ProcessState::kRunning:
      return "running";
    case ProcessState::kStopping:
      break;
  }
  return "stopping";
}

Status::Status(Bus* bus, std::string process, ServiceManager* service)
    : bus_(bus), service_(service), process_(std::move(process)), start_utime_(WallUtime()) {
  bus_->Every(1.0, [this] { Publish(); });
  if (service_ != nullptr && service_->alive_period() > 0)
    bus_->Every(service_->alive_period(), [this] { service_->KeepAlive(); });
}

void Status::Set(ProcessState state, const std::string& message) {
  const std::string text = PrintableText(message);
  if (state == state_ && text == message_) return;
  const bool changed = state != state_;
  state_ = state;
  message_ = text;
  UpdateServiceManager();
  if (changed) Publish();  // a change of the message alone is published with the next STATUS
}

void Status::UpdateServiceManager() {
  if (service_ == nullptr) return;
  service_->SetStatus(message_.empty() ? StateName(state_)
                                       : std::string(StateName(state_)) + ": " + message_);
  if (state_ == ProcessState::kStopping) {
    service_->SetStopping();
  } else if (state_ != ProcessState::kStarting) {
    service_->SetReady();
  }
}

int64_t Status::counter(const std::string& name) const {
  const auto found = counters_.find(name);
  return found == counters_.end() ? 0 : found->second;
}

void Status::SetFindings(const std::string& subject, std::vector<std::string> sentences) {
  const bool fits = findings_.contains(subject) || findings_.size() < kMaxSubjects;
  std::vector<std::string>& known = findings_[fits ? subject : "others"];
  if (sentences.size() > known.size()) {
    for (size_t i = 0; i < sentences.size(); ++i)
      LogWarningRateLimited("finding " + subject + std::to_string(i), sentences[i]);
  }
  known = std::move(sentences);
}

void Status::SetFinding(const std::string& subject, const std::optional<std::string>& sentence) {
  SetFindings(subject, sentence ? std::vector<std::string>{*sentence} : std::vector<std::string>());
}

std::vector<std::string> Status::findings() const {
  std::vector<std::string> all;
  for (const auto& [subject, sentences] : findings_)
    all.insert(all.end(), sentences.begin(), sentences.end());
  return all;
}

void Status::AddTiming(const std::string& stage, double ms) {
  std::vector<double>& timings = timings_ms_[stage];
  if (timings.size() < kMaxTimings) timings.push_back(ms);
  recent_[stage].Add(ms, MonotonicSeconds());
}

void Status::Publish() {
  process_status_t message = MakeStatus(process_, start_utime_);
  message.state = StateName(state_);
  message.message = message_;
  for (const auto& [name, value] : counters_) AddCounter(&message, name, value);
  for (const auto& [channel, counters] : bus_->counters()) AddChannel(&message, channel, counters);
  AddCounter(&message, "reconnects", bus_->reconnects());
  AddCounter(&message, "connections", bus_->connections());
  for (auto& [stage, values] : timings_ms_) {
    if (values.empty()) continue;
    message.timing_names.push_back(stage);
    message.max_ms.push_back(*std::max_element(values.begin(), values.end()));
    message.median_ms.push_back(Median(&values));
    values.clear();
  }
  message.n_timings = static_cast<int32_t>(message.timing_names.size());
  for (auto& [stage, recent] : recent_) {
    const auto percentiles = recent.At(MonotonicSeconds());
    if (!percentiles) continue;
    AddCounter(&message, std::string(kP50Counter) + stage, std::llround(percentiles->p50 * 1e3));
    AddCounter(&message, std::string(kP95Counter) + stage, std::llround(percentiles->p95 * 1e3));
  }
  const std::vector<std::string> all = findings();
  const size_t shown = all.size() > kMaxFindings ? kMaxFindings - 1 : all.size();
  for (size_t i = 0; i < shown; ++i)
    message.findings.push_back(PrintableText(all[i], kMaxFindingLength));
  if (shown < all.size()) {
    message.findings.push_back("there are " + std::to_string(all.size() - shown) +
                               " more findings; the log of this process has them");
  }
  message.n_findings = static_cast<int32_t>(message.findings.size());
  bus_->Publish(kStatusChannel, message);
}

Stopwatch StageTimings(Status* status) {
  return {MonotonicSeconds,
          [status](const char* stage, double ms) { status->AddTiming(stage, ms); }};
}

StageTimer::StageTimer(Status* status, std::string stage)
    : status_(status), stage_(std::move(stage)), start_(MonotonicSeconds()) {}

StageTimer::~StageTimer() { status_->AddTiming(stage_, (MonotonicSeconds() - start_) * 1000); }

}  // namespace vismap
