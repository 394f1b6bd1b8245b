#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/format.h"
#include "base/printable.h"
#include "log_tool/verify.h"
#include "wire/channel_types.h"

namespace vismap {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

int64_t FirstTime(const LogReport& report) {
  int64_t first = INT64_MAX;
  for (const auto& [name, channel] : report.channels) first = std::min(first, channel.first_time);
  return first;
}

const char* TypeName(const std::string& channel) {
  const ChannelType* type = FindChannelType(channel);
  return type == nullptr ? "unknown" : type->type;
}

std::string ChannelLine(const std::string& name, const ChannelReport& channel, int64_t start) {
  const auto seconds = [&](int64_t time) {
    return (static_cast<double>(time) - static_cast<double>(start)) * 1e-6;
  };
  return Format("%-16s %-18s %8lld %10s %8.1f %9.2f %9.2f %7lld %8lld %8lld\n",
                PrintableText(name).c_str(), TypeName(name),
                static_cast<long long>(channel.messages), FormatBytes(channel.bytes).c_str(),
                channel.rate(), seconds(channel.first_time), seconds(channel.last_time),
                static_cast<long long>(channel.lost), static_cast<long long>(channel.repeated),
                static_cast<long long>(channel.other_type + channel.undecodable));
}

}  // namespace

std::string ReportText(const std::string& path, const LogReport& report) {
  std::string text =
      path + ": " + FormatCount(report.events, "message") + ", " + FormatBytes(report.bytes) + "\n";
  text += Format("%-16s %-18s %8s %10s %8s %9s %9s %7s %8s %8s\n", "channel", "type", "messages",
                 "size", "per s", "first [s]", "last [s]", "lost", "repeated", "unusable");
  const int64_t start = FirstTime(report);
  for (const auto& [name, channel] : report.channels) text += ChannelLine(name, channel, start);
  text += Format("frames: %lld sent, %lld integrated, %lld skipped",
                 static_cast<long long>(report.frames_sent),
                 static_cast<long long>(report.frames_integrated),
                 static_cast<long long>(report.frames_skipped));
  if (report.frames_without_commit > 0) {
    text += Format(", %lld without a commit", static_cast<long long>(report.frames_without_commit));
  }
  text += "\n";
  const std::vector<std::string> problems = report.Problems();
  for (const std::string& problem : problems) text += PrintableText(problem) + "\n";
  return text + (problems.empty() ? "no message is lost, and the log is not damaged\n" : "");
}

std::string ReportJson(const std::string& path, const LogReport& report) {
  nlohmann::ordered_json json;
  json["log"] = path;
  json["bytes"] = report.bytes;
  json["events"] = report.events;
  for (const auto& [name, channel] : report.channels) {
    json["channels"][name] = {{"type", TypeName(name)},
                              {"messages", channel.messages},
                              {"bytes", channel.bytes},
                              {"rate", channel.rate()},
                              {"first_utime", channel.first_time},
                              {"last_utime", channel.last_time},
                              {"missing", channel.lost},
                              {"again", channel.repeated},
                              {"other_type", channel.other_type},
                              {"undecodable", channel.undecodable},
                              {"first_problem", channel.first_problem}};
  }
  json["damage"] = nlohmann::ordered_json::array();
  for (const LogDamage& damage : report.damage) {
    json["damage"].push_back(
        {{"offset", damage.offset}, {"bytes", damage.bytes}, {"truncated", damage.truncated}});
  }
  json["frames"] = {{"sent", report.frames_sent},
                    {"integrated", report.frames_integrated},
                    {"skipped", report.frames_skipped},
                    {"without_commit", report.frames_without_commit}};
  json["problems"] = report.Problems();
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace vismap
