#include "doctor/report.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "base/format.h"
#include "base/printable.h"

namespace vismap {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kLossWords[] = {"dropped",  "lost",       "rejected", "unsent",
                                      "replaced", "superseded", "cut_off",  "held_back"};

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  return text;
}

double PerSecond(int64_t count, const Listening& listening) {
  return static_cast<double>(count) / std::max(listening.seconds, 1e-9);
}

// "0.2 s ago"
std::string Ago(double time, const Listening& listening) {
  return Format("%.1f s ago", std::max(0.0, listening.now - time));
}

std::string ProcessTable(const Listening& listening, const BusPicture& picture) {
  std::string text = Format("%-24s %-18s %-8s %7s  %-9s %11s %8s  %s\n", "process", "computer",
                            "version", "pid", "state", "last STATUS", "restarts", "message");
  for (const auto& [name, process] : picture.processes()) {
    const process_status_t& status = process.last;
    text += Format("%-24s %-18s %-8s %7d  %-9s %11s %8d  %s\n", PrintableText(name).c_str(),
                   PrintableText(status.host).c_str(), PrintableText(status.version).c_str(),
                   status.pid, PrintableText(status.state).c_str(),
                   Ago(process.last_heard, listening).c_str(), process.restarts,
                   PrintableText(status.message).c_str());
  }
  return text;
}

std::string ChannelTable(const Listening& listening, const BusPicture& picture) {
  std::string text = Format("%-24s %10s %12s %12s %6s %10s\n", "channel", "messages/s", "data",
                            "last message", "lost", "wrong type");
  for (const auto& [name, channel] : picture.channels()) {
    text += Format("%-24s %10.1f %12s %12s %6lld %10lld\n", PrintableText(name).c_str(),
                   PerSecond(channel.messages, listening),
                   (FormatBytes(PerSecond(channel.bytes, listening)) + "/s").c_str(),
                   Ago(channel.last, listening).c_str(), static_cast<long long>(channel.gaps),
                   static_cast<long long>(channel.foreign));
  }
  return text;
}

// The counters of lost, dropped and rejected messages since the start of the process that are not
// 0.
std::vector<std::pair<std::string, int64_t>> LossesOf(const process_status_t& status) {
  std::vector<std::pair<std::string, int64_t>> losses;
  for (const std::string& name : status.counter_names) {
    const bool loss = std::any_of(std::begin(kLossWords), std::end(kLossWords),
                                  [&](auto* word) { return name.find(word) != std::string::npos; });
    const int64_t value = CounterOf(status, name);
    if (loss && value > 0) losses.emplace_back(name, value);
  }
  return losses;
}

// Number of clients of the hub that publish no STATUS, without this process. Only known when there
// is one hub.
int64_t UnknownClients(const BusPicture& picture) {
  int64_t clients = 0, known = 1, hubs = 0;
  for (const auto& [name, process] : picture.processes()) {
    if (process.last.process == "hub") {
      ++hubs;
      clients += CounterOf(process.last, "clients");
    } else {
      known += std::max<int64_t>(1, CounterOf(process.last, "connections"));
    }
  }
  return hubs == 1 ? std::max<int64_t>(0, clients - known) : 0;
}

// How many frames per second a segmenter processes, and on how many of them a detector ran.
struct DetectionRate {
  std::string segmenter;
  double frames = 0, with_detector = 0;  // [1/s]
};

std::vector<DetectionRate> DetectionRates(const Listening& listening, const BusPicture& picture) {
  std::vector<DetectionRate> rates;
  for (const auto& [name, process] : picture.processes()) {
    if (process.last.process != "depth-segmenter" || process.restarts > 0) continue;
    const auto more = [&](const char* counter) {
      return CounterOf(process.last, counter) - CounterOf(process.first, counter);
    };
    if (more("frames") <= 0) continue;
    rates.push_back({name, PerSecond(more("frames"), listening),
                     PerSecond(more("frames_with_detections"), listening)});
  }
  return rates;
}

std::string RateText(const DetectionRate& rate) {
  std::string text = Format("%s: %.1f frames per second; a detector ran on %.1f of them",
                            PrintableText(rate.segmenter).c_str(), rate.frames, rate.with_detector);
  if (rate.with_detector < 0.9 * rate.frames)
    text += "; the others are mapped without detections, which is no evidence against an object";
  return text + "\n";
}

}  // namespace

std::string TextReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings) {
  const bool received = !picture.channels().empty();
  std::string text = received
                         ? "Observed the bus at " + listening.lcm_url + " for " +
                               FormatDuration(listening.seconds) + ".\n"
                         : "No message was received from the bus at " + listening.lcm_url + ".\n";
  for (const CheckResult& check : listening.checks) {  // the findings have those that failed
    if (check.ok) text += "The " + check.what + " is fine: " + check.found + ".\n";
  }
  if (!picture.processes().empty()) text += "\n" + ProcessTable(listening, picture);
  if (!picture.channels().empty()) text += "\n" + ChannelTable(listening, picture);
  std::string rates;
  for (const DetectionRate& rate : DetectionRates(listening, picture)) rates += RateText(rate);
  for (const auto& [id, camera] : picture.cameras()) {
    if (camera.newest_frame >= 0 && camera.newest_commit >= 0)
      rates += Format("The map is %.1f s behind camera %d.\n", camera.Lag(), id);
  }
  if (!rates.empty()) text += "\n" + rates;
  std::set<std::string> prefixes;
  for (const auto& [name, channel] : picture.channels()) {
    if (!channel.type_of_ours.empty()) prefixes.insert(channel.other_prefix);
  }
  for (const std::string& prefix : prefixes) {
    text += "\nPrograms of vismap with the prefix '" + PrintableText(prefix) +
            "' are on this bus, too; this report is not about them.\n";
  }
  std::string losses;
  for (const auto& [name, process] : picture.processes()) {
    for (const auto& [counter, value] : LossesOf(process.last)) {
      losses += PrintableText(name + "  " + counter) + "  " + FormatCount(value) + "\n";
    }
  }
  if (!losses.empty())
    text += "\nMessages lost, replaced, dropped or rejected since the start of each process:\n" +
            losses;
  if (const int64_t unknown = UnknownClients(picture); unknown > 0) {
    text += "\n" + FormatCount(unknown, "client") +
            " of the hub without STATUS, for example a command of vismap-map or a program that "
            "does not belong to vismap.\n";
  }
  text += findings.empty() ? "\nThe bus is healthy.\n"
                           : "\n" + FormatCount(std::ssize(findings), "problem") + " found:\n";
  for (const Finding& finding : findings) {
    text += "- " + PrintableText(finding.what) + (finding.todo.empty() ? "" : "; " + finding.todo) +
            "\n";
  }
  return text;
}

std::string JsonReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings) {
  Json json = {{"lcm_url", listening.lcm_url},     {"seconds", listening.seconds},
               {"healthy", findings.empty()},      {"checks", Json::array()},
               {"processes", Json::array()},       {"channels", Json::array()},
               {"detection_rates", Json::array()}, {"unknown_clients", UnknownClients(picture)},
               {"cameras", Json::array()},         {"findings", Json::array()}};
  for (const CheckResult& check : listening.checks) {
    json["checks"].push_back({{"what", check.what}, {"ok", check.ok}, {"found", check.found}});
  }
  for (const auto& [name, process] : picture.processes()) {
    const process_status_t& status = process.last;
    Json losses = Json::object();
    for (const auto& [counter, value] : LossesOf(status)) losses[counter] = value;
    json["processes"].push_back({{"name", name},
                                 {"program", status.process},
                                 {"computer", status.host},
                                 {"pid", status.pid},
                                 {"version", status.version},
                                 {"state", status.state},
                                 {"message", status.message},
                                 {"age_s", listening.now - process.last_heard},
                                 {"clock_difference_s", process.clock_difference},
                                 {"restarts", process.restarts},
                                 {"losses", losses},
                                 {"findings", status.findings}});
  }
  for (const auto& [name, channel] : picture.channels()) {
    json["channels"].push_back({{"name", name},
                                {"messages_per_s", PerSecond(channel.messages, listening)},
                                {"bytes_per_s", PerSecond(channel.bytes, listening)},
                                {"age_s", listening.now - channel.last},
                                {"gaps", channel.gaps},
                                {"foreign", channel.foreign},
                                {"type_of_other_prefix", channel.type_of_ours}});
  }
  for (const DetectionRate& rate : DetectionRates(listening, picture)) {
    json["detection_rates"].push_back({{"segmenter", rate.segmenter},
                                       {"frames_per_s", rate.frames},
                                       {"with_detector_per_s", rate.with_detector}});
  }
  for (const auto& [id, camera] : picture.cameras()) {
    if (camera.newest_frame >= 0 && camera.newest_commit >= 0)
      json["cameras"].push_back({{"camera_id", id}, {"lag_s", camera.Lag()}});
  }
  for (const Finding& finding : findings) {
    json["findings"].push_back({{"what", finding.what}, {"todo", finding.todo}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vismap
