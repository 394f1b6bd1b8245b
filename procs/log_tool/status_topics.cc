#include "log_tool/status_topics.h"

#include <nlohmann/json.hpp>

#include "base/printable.h"
#include "mcap/camera_messages.h"

namespace vismap {
namespace {

constexpr size_t kMostSources = 256;  // with a topic of their own

using StatusObject = nlohmann::ordered_json;

template <typename Number>
StatusObject NamedNumbers(const std::vector<std::string>& names,
                          const std::vector<Number>& values) {
  StatusObject json = StatusObject::object();
  for (size_t i = 0; i < names.size() && i < values.size(); ++i) json[names[i]] = values[i];
  return json;
}

std::string StatusText(const process_status_t& status) {
  const StatusObject json{{"source", status.source},
                          {"process", status.process},
                          {"host", status.host},
                          {"pid", status.pid},
                          {"start_utime", status.start_utime},
                          {"state", status.state},
                          {"message", status.message},
                          {"version", status.version},
                          {"counters", NamedNumbers(status.counter_names, status.counter_values)},
                          {"median_ms", NamedNumbers(status.timing_names, status.median_ms)},
                          {"max_ms", NamedNumbers(status.timing_names, status.max_ms)},
                          {"findings", status.findings}};
  return json.dump(-1, ' ', false, StatusObject::error_handler_t::replace);
}

std::string LastWords(const process_status_t& status) {
  std::string words = status.state;
  if (!status.message.empty()) words += ": " + status.message;
  for (const std::string& finding : status.findings) words += "; " + finding;
  return words;
}

}  // namespace

void StatusTopics::Write(const process_status_t& status, int64_t log_us) {
  const MessageTimes times{log_us, status.utime};
  const bool known = last_words_.contains(status.source);
  const bool room = known || last_words_.size() < kMostSources;
  file_.WriteJson(room ? "/status/" + PrintableText(status.source) : "/status", times,
                  "vismap.process_status", StatusText(status));
  const std::string words = LastWords(status);
  if (known && last_words_[status.source] == words) return;
  if (room) last_words_[status.source] = words;
  const bool fine = status.message.empty() && status.findings.empty();
  file_.Write("/log", times,
              NoteMessage(fine ? NoteLevel::kInfo : NoteLevel::kWarning, status.source, words,
                          status.utime));
}

}  // namespace vismap
