#include "runtime/main.h"

#include <CLI/CLI.hpp>

#include "octomap_exporter/exporter.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

Outcome Serve(ProcessContext& context, const VismapConfig& config) {
  Exporter exporter(config, context.bus, context.status);
  context.status->Set(ProcessState::kReady);
  context.bus->Run();
  if (!exporter.has_news()) return {};
  const Result<std::string> exported = exporter.Export();
  if (!exported) return ExitWith(ExitCode::kFailed, exported.error().message);
  LogInfo(*exported);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  VismapConfig config;
  std::string folder;
  ThreadOption threads;
  ProcessSpec spec;
  spec.name = "octomap-exporter";
  spec.summary =
      "Follows a map and hands its free and occupied space to planners as OctoMap octrees.";
  spec.add_options = [&](CLI::App& app) {
    app.add_option("--out", folder,
                   "Folder for octree.bt and octree.closed.bt; overrides the config");
    threads.AddTo(app);
  };
  spec.configure = [&](const std::string& text, const std::string& path) {
    const Result<std::string> taken = TakeConfig(text, path, &config);
    if (taken && !folder.empty()) config.octomap_exporter.output_folder = folder;
    return taken ? PrintConfig(config) : taken;
  };
  spec.run = [&](ProcessContext& context) {
    const std::unique_ptr<ThreadLimit> limit = threads.Limit();
    return Serve(context, config);
  };
  return RunProcess(argc, argv, spec);
}
