#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "logs/check_recording.h"
#include "logs/log_reader.h"
#include "wire/frame_key.h"

namespace vismap {

/// Statistics of one channel of a log.
struct ChannelReport {
  int64_t messages = 0;
  int64_t bytes = 0;
  int64_t first_time = 0, last_time = 0;  ///< of recording [us since 1970]
  int64_t lost = 0;                       ///< missing sequence numbers, over all sources
  /// Sequence numbers that did not increase: a source was restarted or repeated a message.
  int64_t repeated = 0;
  int64_t other_type = 0;   ///< messages with another fingerprint than the type of the channel
  int64_t undecodable = 0;  ///< messages of the right type with a wrong checksum or wrong lengths
  /// First problem of the last two kinds, with its position in the file.
  std::string first_problem;

  double rate() const;  ///< messages per second
};

/// The result of `vismap-log verify`.
struct LogReport {
  uint64_t bytes = 0;               ///< of the file
  std::string channel_prefix = {};  ///< of our channels; `channels` has the names with it
  int64_t events = 0;
  std::map<std::string, ChannelReport> channels;
  std::vector<LogDamage> damage;

  int64_t frames_sent = 0;  ///< number of different frames
  int64_t frames_integrated = 0, frames_skipped = 0;
  int64_t frames_without_commit = 0;      ///< 0 if the log has no commits at all
  std::vector<std::string> run_problems;  ///< why the recorded map cannot be reproduced
  RecordingCheck recording;               ///< of the frames with different utimes

  /// Sentences, the most serious first; empty = no problem.
  std::vector<std::string> Problems() const;
};

/// Reads and checks every message of the log. Fails when the file cannot be read.
Result<LogReport> VerifyLog(LogReader& reader);

/// The report as a table for people, and as a JSON object.
std::string ReportText(const std::string& path, const LogReport& report);
std::string ReportJson(const std::string& path, const LogReport& report);

}  // namespace vismap
