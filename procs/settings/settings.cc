#include "settings/settings.h"

namespace vismap {

namespace {

// Checks a config that the command line may have changed, and returns it in full.
Result<std::string> CheckConfig(const VismapConfig& config) {
  const std::vector<std::string> problems = Validate(config);
  if (!problems.empty()) return Fail("command line: " + problems.front());
  return PrintConfig(config);
}

}  // namespace

void UseConfig(VismapConfig* config, ProcessSpec* spec,
               const std::function<Result<void>()>& check) {
  spec->read_config = [config](const std::string& text, const std::string& path) {
    return ReadConfig(text, path, config);
  };
  spec->check_config = [config, check]() -> Result<std::string> {
    if (const Result<void> checked = check(); !checked) return tl::unexpected(checked.error());
    DeriveOptions(config);
    return CheckConfig(*config);
  };
}

Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config) {
  Result<VismapConfig> parsed = ParseValidConfig(text, path.empty() ? "defaults" : path);
  if (!parsed) return tl::unexpected(parsed.error());
  *config = std::move(*parsed);
  return {};
}

void ThreadOption::AddTo(CommandLine& line) {
  line.Option("--threads", &threads_, "Number of threads; 0 = all processors").AtLeast(0);
}

std::unique_ptr<ThreadLimit> ThreadOption::Limit() const {
  return threads_ > 0 ? std::make_unique<ThreadLimit>(threads_) : nullptr;
}

}  // namespace vismap
