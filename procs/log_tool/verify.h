#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "logs/log_reader.h"
#include "wire/frame_key.h"

namespace vismap {

/// Figures of one channel of a log.
struct ChannelReport {
  int64_t messages = 0;
  int64_t bytes = 0;
  int64_t first_time = 0, last_time = 0;  ///< when recorded [us since 1970]
  int64_t lost = 0;                       ///< numbers missing in the sequences of the sources
  int64_t repeated = 0;       ///< numbers that did not go on: a source was restarted, or sent twice
  int64_t other_type = 0;     ///< another fingerprint than the channel's type has
  int64_t undecodable = 0;    ///< of the right type, but checksum, lengths or end are wrong
  std::string first_problem;  ///< of the last two, with its place in the file

  double rate() const;  ///< messages a second
};

/// Everything that `vismap-log verify` tells.
struct LogReport {
  uint64_t bytes = 0;  ///< of the file
  int64_t events = 0;
  std::map<std::string, ChannelReport> channels;
  std::vector<LogDamage> damage;

  int64_t frames_sent = 0;  ///< different ones
  int64_t frames_integrated = 0, frames_skipped = 0;
  int64_t frames_without_commit = 0;      ///< only counted when there are commits
  std::vector<std::string> run_problems;  ///< what the recorded map cannot be made of again

  /// Sentences, the worst first; empty = the log is clean.
  std::vector<std::string> Problems() const;
};

/// Goes through the whole log once and looks at every message. Fails when the file cannot be read.
Result<LogReport> VerifyLog(LogReader& reader);

/// As a table, or as one JSON object.
std::string ReportText(const std::string& path, const LogReport& report);
std::string ReportJson(const std::string& path, const LogReport& report);

}  // namespace vismap
