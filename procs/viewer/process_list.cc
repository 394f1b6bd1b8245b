#include "viewer/process_list.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "runtime/status.h"

namespace vismap {
namespace {

constexpr int64_t kShortestPeriod = 200000;  // between two STATUS that rates are made of [us]

using StatusJson = nlohmann::ordered_json;

// By how much counters of one run of a process grew per second.
std::map<std::string, double> RatesOf(const process_status_t& before,
                                      const process_status_t& after) {
  std::map<std::string, double> rates;
  std::map<std::string, int64_t> old;
  for (size_t i = 0; i < before.counter_names.size(); ++i)
    old[before.counter_names[i]] = before.counter_values[i];
  const double seconds = static_cast<double>(after.utime - before.utime) * 1e-6;
  for (size_t i = 0; i < after.counter_names.size(); ++i) {
    const auto found = old.find(after.counter_names[i]);
    if (found == old.end()) continue;
    const double grown =
        static_cast<double>(after.counter_values[i]) - static_cast<double>(found->second);
    if (grown > 0) rates[after.counter_names[i]] = grown / seconds;
  }
  return rates;
}

StatusJson ToJson(const process_status_t& status, double age,
                  const std::map<std::string, double>& rates) {
  StatusJson json{{"source", status.source},  {"process", status.process}, {"host", status.host},
                  {"state", status.state},    {"message", status.message}, {"age_s", age},
                  {"version", status.version}};
  json["counters"] = json["timings"] = StatusJson::object();
  for (size_t i = 0; i < status.timing_names.size(); ++i)
    json["timings"][status.timing_names[i]] = {{"median_ms", status.median_ms[i]},
                                               {"max_ms", status.max_ms[i]}};
  for (size_t i = 0; i < status.counter_names.size(); ++i) {
    const std::string& name = status.counter_names[i];
    const int64_t value = status.counter_values[i];
    if (name.starts_with(kP50Counter)) {
      json["timings"][name.substr(kP50Counter.size())]["p50_ms"] = static_cast<double>(value) / 1e3;
    } else if (name.starts_with(kP95Counter)) {
      json["timings"][name.substr(kP95Counter.size())]["p95_ms"] = static_cast<double>(value) / 1e3;
    } else {
      json["counters"][name] = value;
    }
  }
  json["rates"] = StatusJson::object();
  for (const auto& [name, rate] : rates) {
    if (!IsPercentile(name)) json["rates"][name] = rate;
  }
  json["findings"] = status.findings;
  return json;
}

}  // namespace

std::map<std::string, int64_t> MemoryLayers(const process_status_t& status) {
  constexpr std::string_view kBegin = "memory.", kEnd = "_bytes";
  std::map<std::string, int64_t> layers;
  for (size_t i = 0; i < status.counter_names.size(); ++i) {
    const std::string& name = status.counter_names[i];
    if (name.size() <= kBegin.size() + kEnd.size()) continue;
    if (!name.starts_with(kBegin) || !name.ends_with(kEnd)) continue;
    layers[name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size())] =
        status.counter_values[i];
  }
  return layers;
}

void ProcessList::Add(const process_status_t& status, double now) {
  const auto known = heard_.find(status.source);
  if (known == heard_.end()) {
    if (heard_.size() < kMost) heard_[status.source] = {status, now, {}};
    return;
  }
  Heard& heard = known->second;
  heard.at = now;
  const bool restarted = heard.status.start_utime != status.start_utime;
  const int64_t period = status.utime - heard.status.utime;
  // A STATUS right after a change of state says too little about rates.
  if (restarted || period >= kShortestPeriod) {
    heard.rates = restarted ? std::map<std::string, double>() : RatesOf(heard.status, status);
    heard.status = status;
    return;
  }
  heard.status.state = status.state;
  heard.status.message = status.message;
  if (period < 0) heard.status = status;  // the clock of its computer was set back
}

bool ProcessList::IsAlive(const std::string& process, double now) const {
  constexpr double kPatience = 3;  // [s]
  return std::any_of(heard_.begin(), heard_.end(), [&](const auto& entry) {
    return entry.second.status.process == process && now - entry.second.at < kPatience;
  });
}

std::string ProcessList::Text(double now, int64_t now_utime) {
  std::erase_if(heard_, [&](const auto& e) { return now - e.second.at > kForgetAfter; });
  StatusJson json{
      {"kind", "processes"}, {"now_utime", now_utime}, {"processes", StatusJson::array()}};
  for (const auto& [source, heard] : heard_)
    json["processes"].push_back(ToJson(heard.status, now - heard.at, heard.rates));
  return json.dump(-1, ' ', false, StatusJson::error_handler_t::replace);
}

}  // namespace vismap
