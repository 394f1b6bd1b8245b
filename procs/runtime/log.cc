#include "runtime/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <map>
#include <mutex>

#include "base/format.h"

namespace vismap {
namespace {

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

}  // namespace

void SetUpLog(const std::string& process, LogLevel level) {
  Logger().set_pattern("%^%-7l%$ " + process + " %Y-%m-%d %H:%M:%S.%e %v");
  Logger().set_level(ToSpdlog(level));
}

void LogDebug(std::string_view sentence) { Logger().debug("{}", sentence); }
void LogInfo(std::string_view sentence) { Logger().info("{}", sentence); }
void LogWarning(std::string_view sentence) { Logger().warn("{}", sentence); }
void LogError(std::string_view sentence) { Logger().error("{}", sentence); }

void LogWarningRateLimited(const std::string& key, std::string_view sentence) {
  struct Past {
    std::chrono::steady_clock::time_point last;
    int left_out = 0;
  };
  static std::mutex mutex;
  static std::map<std::string, Past> pasts;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto now = std::chrono::steady_clock::now();
  const auto [entry, first] = pasts.try_emplace(key, Past{now, 0});
  Past& past = entry->second;
  if (!first && now - past.last < std::chrono::seconds(5)) {
    ++past.left_out;
    return;
  }
  const std::string more =
      past.left_out == 0
          ? ""
          : " (" + FormatCount(past.left_out, "similar warning") + " left out before)";
  past = {now, 0};
  LogWarning(std::string(sentence) + more);
}

}  // namespace vismap
