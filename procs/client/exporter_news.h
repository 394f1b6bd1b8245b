#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vismap/navigation_status_t.hpp>

namespace vismap {

/// Of a moment that has not been yet, MonotonicSeconds.
inline constexpr double kNever = -std::numeric_limits<double>::infinity();

/// "2.8 s".
std::string SecondsText(double seconds);

/// What was heard of the octomap exporter and of the map server. Times are MonotonicSeconds.
struct ExporterNews {
  bool connected = true;
  std::string failure;  ///< why no messages are handled any more; "" = they are
  double exporter_heard = kNever;
  double server_heard = kNever;                       ///< by this program or by the exporter
  double server_followed = kNever;                    ///< by the exporter alone
  std::shared_ptr<const navigation_status_t> status;  ///< the newest

  void Hear(std::shared_ptr<const navigation_status_t> message, double now);

  /// Why what the exporter publishes can be no longer the newest state of the map; "" = all speak.
  std::string WhySilent(double max_silence, double now) const;
  /// What the exporter says of a channel: its message, unless it begins with the name of another
  /// channel. "" = nothing.
  std::string MessageOn(const std::string& channel) const;
};

/// What a channel carries, for sentences.
struct OutputName {
  std::string channel, noun;
  std::string key;  ///< of the config, without which the exporter does not publish it; "" = none
};

/// How far the newest message of a channel can be trusted.
struct OutputState {
  std::string map_id;
  int64_t revision = -1;      ///< -1 = there is none
  double since = kNever;      ///< when it was received for the first time
  double confirmed = kNever;  ///< when it was known to be the newest state of the map
  std::string problem;        ///< why the message that came last is not it

  /// A message has come that differs from the one before.
  void Renew(std::string new_map_id, int64_t new_revision, const ExporterNews& news,
             double max_silence, double now);
  /// NAVIGATION has come.
  void Confirm(const std::string& channel, const ExporterNews& news);
  /// One sentence; "" = it is the newest state of the map.
  std::string WhyStale(const OutputName& name, const ExporterNews& news, double max_silence,
                       double now) const;
};

}  // namespace vismap
