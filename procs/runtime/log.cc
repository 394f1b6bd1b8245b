#include "runtime/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>

#include "base/format.h"
#include "base/printable.h"

namespace vismap {
namespace {

using Clock = std::chrono::steady_clock;

constexpr size_t kMaxLine = 8000;  // [bytes]
// Lines that are not limited by kind: a burst of so many, and in the long run so many per second.
constexpr double kBurstLines = 1000, kLinesPerSecond = 10;
constexpr std::chrono::seconds kKindPeriod{5}, kForgetKindAfter{60};
constexpr size_t kMaxKinds = 64;

spdlog::logger& Logger() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto made = std::make_shared<spdlog::logger>(
        "vismap", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made->set_pattern("%^%-7l%$ %n %Y-%m-%d %H:%M:%S.%e %v");
    made->flush_on(spdlog::level::debug);
    return made;
  }();
  return *logger;
}

spdlog::level::level_enum ToSpdlog(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarning:
      return spdlog::level::warn;
    case LogLevel::kError:
      break;
  }
  return spdlog::level::err;
}

LogFormat log_format = LogFormat::kText;

/// Writes a sentence as one line, since it may have text from the bus in it.
void Write(LogLevel level, std::string_view sentence) {
  const std::string line = log_format == LogFormat::kJson ? JsonLogLine(level, sentence)
                                                          : PrintableText(sentence, kMaxLine);
  Logger().log(ToSpdlog(level), "{}", line);
}

std::string LeftOut(int64_t count, const char* what) {
  return count == 0 ? "" : " (" + FormatCount(count, what) + " left out before)";
}

/// Writes a sentence unless there were too many in a short time, so that no cause, known or not,
/// can fill the disk.
void WriteWithinBudget(LogLevel level, std::string_view sentence) {
  static std::mutex mutex;
  static double lines = kBurstLines;
  static Clock::time_point last = Clock::now();
  static int64_t left_out = 0;
  if (!Logger().should_log(ToSpdlog(level))) return;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - std::exchange(last, now)).count();
  lines = std::min(kBurstLines, lines + kLinesPerSecond * seconds);
  if (lines < 1) {
    ++left_out;
    return;
  }
  --lines;
  Write(level, std::string(sentence) + LeftOut(std::exchange(left_out, 0), "line"));
}

/// When lines of one kind were written last, and how many were left out since.
struct Past {
  Clock::time_point last;
  int64_t left_out = 0;
};

/// The past of a kind. There is room for so many kinds, since a name from the bus may be part of a
/// kind; the others are one kind together.
Past& PastOf(const std::string& key, Clock::time_point now, std::map<std::string, Past>* pasts) {
  if (pasts->size() >= kMaxKinds && !pasts->contains(key)) {
    std::erase_if(*pasts,
                  [&](const auto& entry) { return now - entry.second.last > kForgetKindAfter; });
  }
  const bool fits = pasts->contains(key) || pasts->size() < kMaxKinds;
  return pasts->try_emplace(fits ? key : "others", Past{now - 2 * kKindPeriod}).first->second;
}

}  // namespace

void SetUpLog(const std::string& process, LogLevel level, LogFormat format) {
  log_format = format;
  Logger().set_pattern(
      format == LogFormat::kJson ? "%v" : "%^%-7l%$ " + process + " %Y-%m-%d %H:%M:%S.%e %v");
  Logger().set_level(ToSpdlog(level));
}

std::string JsonLogLine(LogLevel level, std::string_view sentence) {
  constexpr std::array<const char*, 4> kNames = {"debug", "info", "warning", "error"};
  std::string line =
      std::string("{\"level\":\"") + kNames.at(static_cast<size_t>(level)) + "\",\"message\":\"";
  for (const char c : PrintableText(sentence, kMaxLine)) {
    if (c == '"' || c == '\\') line += '\\';
    line += c;
  }
  return line + "\"}";
}

void LogDebug(std::string_view sentence) { WriteWithinBudget(LogLevel::kDebug, sentence); }
void LogInfo(std::string_view sentence) { WriteWithinBudget(LogLevel::kInfo, sentence); }
void LogWarning(std::string_view sentence) { WriteWithinBudget(LogLevel::kWarning, sentence); }
void LogError(std::string_view sentence) { Write(LogLevel::kError, sentence); }

void LogWarningRateLimited(const std::string& key, std::string_view sentence) {
  static std::mutex mutex;
  static std::map<std::string, Past> pasts;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto now = Clock::now();
  Past& past = PastOf(key, now, &pasts);
  if (now - past.last < kKindPeriod) {
    ++past.left_out;
    return;
  }
  const int64_t left_out = std::exchange(past, Past{now}).left_out;
  Write(LogLevel::kWarning, std::string(sentence) + LeftOut(left_out, "similar warning"));
}

}  // namespace vismap
