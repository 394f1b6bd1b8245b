#pragma once

#include <string>
#include <string_view>

namespace vismap {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Sets the name of the process ("depth-segmenter") and the lowest level that is shown. Log lines
/// go to stderr and consist of level, process, local time and sentence.
void SetUpLog(const std::string& process, LogLevel level);

void LogDebug(std::string_view sentence);
void LogInfo(std::string_view sentence);
void LogWarning(std::string_view sentence);
void LogError(std::string_view sentence);

/// Like LogWarning, but at most one line per key in 5 s; that line then says how many similar ones
/// were left out before it.
void LogWarningRateLimited(const std::string& key, std::string_view sentence);

}  // namespace vismap
