#pragma once

#include <string>
#include <string_view>

namespace vismap {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Sets where log lines come from ("depth-segmenter") and which are shown. Lines go to stderr:
/// level, process, utime [us], sentence.
void SetUpLog(const std::string& process, LogLevel level);

void LogDebug(std::string_view sentence);
void LogInfo(std::string_view sentence);
void LogWarning(std::string_view sentence);
void LogError(std::string_view sentence);

/// Like LogWarning, but lines with the same key come at most every 5 s; the next one then says how
/// many were kept back.
void LogWarningRateLimited(const std::string& key, std::string_view sentence);

}  // namespace vismap
