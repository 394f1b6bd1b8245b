#pragma once

#include <string>
#include <string_view>

namespace vismap {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// How a line of the log looks.
enum class LogFormat {
  kText,  ///< level, process, local time and sentence
  kJson,  ///< {"level":"info","message":"..."}, for programs that start this one and read its log
};

// A sentence becomes one line of the log, escaped by PrintableText, because it may have text from
// the bus in it. Of all lines below errors that are not limited by kind, a process writes a burst
// of 1000 and then 10 per second; the next line says how many were left out.

/// Sets the name of the process ("depth-segmenter") and the lowest level that is shown. Log lines
/// go to stderr.
void SetUpLog(const std::string& process, LogLevel level, LogFormat format = LogFormat::kText);

/// A sentence as a line in LogFormat::kJson.
std::string JsonLogLine(LogLevel level, std::string_view sentence);

void LogDebug(std::string_view sentence);
void LogInfo(std::string_view sentence);
void LogWarning(std::string_view sentence);
void LogError(std::string_view sentence);

/// Like LogWarning, for what messages on the bus can cause any number of times: at most one line
/// per kind (`key`) in 5 s, which then says how many similar ones were left out before it. A key
/// should be a constant; beyond 64 keys all further ones count as one.
void LogWarningRateLimited(const std::string& key, std::string_view sentence);

}  // namespace vismap
