#include "runtime/main.h"

#include "map_server/map_server.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

Outcome Serve(ProcessContext& context, const VismapConfig& config) {
  MapServer server(config, context.bus, context.status);
  LiveMap& map = server.map();
  if (config.map_server.recover || !config.map_server.load.empty()) {
    const Result<std::string> loaded =
        config.map_server.recover ? map.Recover() : map.Load(config.map_server.load);
    if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
    LogInfo(*loaded);
  }
  context.status->Set(ProcessState::kReady, map.StatusMessage());
  context.bus->Run();
  context.status->Set(ProcessState::kStopping);
  if (config.map_server.save_on_exit.empty()) return {};
  const Result<std::string> saved = map.Save("");
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
  spec.add_options = [&](CommandLine& line) { threads.AddTo(line); };
  UseConfig(&config, &spec);
  spec.run = [&](ProcessContext& context) {
    const std::unique_ptr<ThreadLimit> limit = threads.Limit();
    return Serve(context, config);
  };
  return RunProcess(argc, argv, spec);
}
