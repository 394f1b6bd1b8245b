#include "client/exporter_news.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace vismap {
namespace {

constexpr double kOverdue = 1.6;  // after so long a message once a second is missing [s]

bool IsPublished(const std::string& channel, const navigation_status_t& status) {
  const auto found = std::find(status.channels.begin(), status.channels.end(), channel);
  if (found == status.channels.end()) return false;
  return status.revisions[static_cast<size_t>(found - status.channels.begin())] >= 0;
}

}  // namespace

std::string SecondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", seconds);
  return text;
}

void ExporterNews::Hear(std::shared_ptr<const navigation_status_t> message, double now) {
  exporter_heard = now;
  if (message->server_utime > 0) {
    const auto silent =
        static_cast<double>(message->published_utime - message->server_utime) * 1e-6;
    server_followed = std::max(server_followed, now - std::max(silent, 0.0));
    server_heard = std::max(server_heard, server_followed);
  }
  status.swap(message);
}

std::string ExporterNews::WhySilent(double max_silence, double now) const {
  if (!failure.empty()) return failure;
  if (!connected) return "there is no connection to the hub at present";
  if (exporter_heard == kNever) {
    return "nothing was heard of the octomap exporter yet; vismap-octomap-exporter is not running "
           "on this bus, or has just started";
  }
  const double exporter = now - exporter_heard, server = now - server_heard;
  const bool overdue = server > max_silence && exporter > kOverdue;
  if (exporter > max_silence || overdue)
    return "the octomap exporter was not heard for " + SecondsText(exporter);
  if (!status) return "nothing was heard on NAVIGATION yet";
  if (server_heard == kNever) return "the octomap exporter has not heard a map server yet";
  if (server > max_silence) return "the map server was not heard for " + SecondsText(server);
  return "";
}

std::string ExporterNews::MessageOn(const std::string& channel) const {
  if (!status) return "";
  const std::string& message = status->message;
  const size_t colon = message.find(": ");
  const bool names_channel = colon != std::string::npos && colon > 0 &&
                             message.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == colon;
  return names_channel && message.substr(0, colon) != channel ? "" : message;
}

void OutputState::Renew(std::string new_map_id, int64_t new_revision, const ExporterNews& news,
                        double max_silence, double now) {
  map_id = std::move(new_map_id);
  revision = new_revision;
  since = now;
  const bool server_lives = now - news.server_followed <= max_silence;
  confirmed = news.status ? (server_lives ? now : news.server_followed) : kNever;
}

void OutputState::Confirm(const std::string& channel, const ExporterNews& news) {
  const navigation_status_t& status = *news.status;
  if (revision < 0 || map_id != status.map_id || !IsPublished(channel, status)) return;
  if (status.in_sync && revision == status.revision) {
    confirmed = std::max(confirmed, news.server_followed);
  } else if (confirmed == kNever) {
    confirmed = std::min(since, news.server_followed);
  }
}

std::string OutputState::WhyStale(const OutputName& name, const ExporterNews& news,
                                  double max_silence, double now) const {
  if (std::string silent = news.WhySilent(max_silence, now); !silent.empty()) return silent;
  const navigation_status_t& status = *news.status;
  const std::string message = news.MessageOn(name.channel);
  if (!problem.empty()) return problem;
  if (revision < 0) {
    std::string none = "no " + name.noun + " has come on " + name.channel + " yet";
    if (!message.empty()) return none + ": " + message;
    return name.key.empty() ? none : none + "; the exporter sends it when " + name.key + " is set";
  }
  if (!status.map_id.empty() && status.map_id != map_id) {
    return "the map was replaced by another one, of which no " + name.noun + " has come on " +
           name.channel;
  }
  const bool behind = status.revision > revision || !IsPublished(name.channel, status);
  return behind ? message : "";
}

}  // namespace vismap
