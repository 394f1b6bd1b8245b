#include "runtime/main.h"

#include <filesystem>

#include "base/probe_folder.h"
#include "octomap_exporter/exporter.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

// A folder that cannot be written is found at the start, and not after hours of mapping.
Outcome MakeFolder(const std::string& folder) {
  if (folder.empty()) return {};
  const Result<void> usable = ProbeFolder(std::filesystem::absolute(folder), 1);
  if (!usable) return ExitWith(ExitCode::kUsage, usable.error().message);
  return {};
}

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
  ThreadOption threads;
  ProcessSpec spec;
  spec.name = "octomap-exporter";
  spec.summary =
      "Publishes the free and occupied space of the map as OctoMap octrees for planners.";
  spec.add_options = [&](CommandLine& line) {
    line.Option("--out", &config.octomap_exporter.output_folder,
                "Folder for octree.bt and octree.closed.bt");
    threads.AddTo(line);
  };
  UseConfig(&config, &spec);
  spec.prepare = [&] { return MakeFolder(config.octomap_exporter.output_folder); };
  spec.run = [&](ProcessContext& context) {
    const std::unique_ptr<ThreadLimit> limit = threads.Limit();
    return Serve(context, config);
  };
  return RunProcess(argc, argv, spec);
}
