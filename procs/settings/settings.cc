#include "settings/settings.h"

namespace vismap {

void UseConfig(VismapConfig* config, ProcessSpec* spec) {
  spec->read_config = [config](const std::string& text, const std::string& path) {
    return ReadConfig(text, path, config);
  };
  spec->check_config = [config] { return CheckConfig(*config); };
}

Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config) {
  Result<VismapConfig> parsed = ParseValidConfig(text, path.empty() ? "defaults" : path);
  if (!parsed) return tl::unexpected(parsed.error());
  *config = std::move(*parsed);
  return {};
}

Result<std::string> CheckConfig(const VismapConfig& config) {
  const std::vector<std::string> problems = Validate(config);
  if (!problems.empty()) return Fail("command line: " + problems.front());
  return PrintConfig(config);
}

void ThreadOption::AddTo(CommandLine& line) {
  line.Option("--threads", &threads_, "Number of threads; 0 = all processors").AtLeast(0);
}

std::unique_ptr<ThreadLimit> ThreadOption::Limit() const {
  return threads_ > 0 ? std::make_unique<ThreadLimit>(threads_) : nullptr;
}

MapSessionOptions SessionOptionsOf(const VismapConfig& config) {
  return {config.grid, config.association, config.integration};
}

OutputOptions OutputOptionsOf(const VismapConfig& config) {
  return {config.meshing,    config.objects,           config.up_W,
          config.free_space, config.octree.resolution, config.octree.free_fraction};
}

}  // namespace vismap
