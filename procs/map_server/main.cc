#include "runtime/main.h"

#include <filesystem>

#include "map_server/map_server.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

// What the options name must be of the right kind, where it exists already.
Result<void> CheckPaths(const MapServerOptions& options) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::path file = options.save_on_exit, folder = options.map_folder;
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
    return Fail("map_server.save_on_exit: " + file.string() + " is no regular file");
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
    return Fail("map_server.map_folder: " + folder.string() + " is no folder");
  return {};
}

Outcome Serve(ProcessContext& context, const VismapConfig& config) {
  context.bus->SendByThread();  // so that the mapping does not wait until a whole map is sent
  MapServer server(config, context.bus, context.status);
  LiveMap& map = server.map();
  if (config.map_server.recover || !config.map_server.load.empty()) {
    const Result<std::string> loaded =
        config.map_server.recover ? map.Recover() : map.Load(config.map_server.load);
    if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
    LogInfo(*loaded);
  }
  context.status->Set(ProcessState::kReady, map.StatusMessage());
  server.Run();
  context.status->Set(ProcessState::kStopping);
  server.Finish();
  LogInfo(server.Summary());
  if (config.map_server.save_on_exit.empty()) return {};
  const Result<std::string> saved = map.SaveAtEnd();
  if (!saved) return ExitWith(ExitCode::kFailed, saved.error().message);
  LogInfo(*saved);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  VismapConfig config;
  ThreadOption threads;
  ProcessSpec spec;
  spec.name = "map-server";
  spec.summary =
      "Builds the map: integrates segmented frames, publishes the changes, answers requests.";
  spec.add_options = [&](CommandLine& line) {
    MapServerOptions& options = config.map_server;
    line.Option("--load", &options.load, "Continue the map in this file");
    line.Option("--save-on-exit", &options.save_on_exit, "Save the map to this file when stopped");
    line.Option("--map-folder", &options.map_folder,
                "Folder of the maps that clients may save and load by name; empty = they may not");
    threads.AddTo(line);
  };
  UseConfig(&config, &spec, [&] { return CheckPaths(config.map_server); });
  spec.run = [&](ProcessContext& context) {
    const std::unique_ptr<ThreadLimit> limit = threads.Limit();
    return Serve(context, config);
  };
  return RunProcess(argc, argv, spec);
}
