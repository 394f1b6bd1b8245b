#include "settings/settings.h"

#include <CLI/CLI.hpp>

namespace vismap {

Result<std::string> TakeConfig(const std::string& text, const std::string& path,
                               VismapConfig* config) {
  Result<VismapConfig> parsed = ParseValidConfig(text, path.empty() ? "defaults" : path);
  if (!parsed) return tl::unexpected(parsed.error());
  *config = std::move(*parsed);
  return PrintConfig(*config);
}

void ThreadOption::AddTo(CLI::App& app) {
  app.add_option("--threads", threads_, "Threads to use; 0 = all processors")
      ->check(CLI::NonNegativeNumber);
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
