#include "runtime/main.h"

#include <cstdio>
#include <filesystem>
#include <optional>

#include "settings/settings.h"
#include "viewer/log_viewer.h"
#include "viewer/viewer.h"

namespace {

using namespace vismap;

// The page beside an installed program, or in the build folder.
std::string FindPage(const std::string& configured) {
  if (!configured.empty()) return configured;
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed = program.parent_path() / "../share/vismap/page";
  const auto built = program.parent_path() / "../../page";
  return (std::filesystem::exists(built / "index.html", error) ? built : installed)
      .lexically_normal()
      .string();
}

void TellAddress(const std::string& page, const std::string& address) {
  if (!std::filesystem::exists(std::filesystem::path(page) / "index.html"))
    LogWarning("there is no page in " + page + "; scripts/page builds it");
  LogInfo("the page is at " + address);
  std::printf("%s\n", address.c_str());
  std::fflush(stdout);
}

Outcome ServeLog(const ProcessContext& context, const VismapConfig& config,
                 const std::string& path) {
  const Result<std::unique_ptr<LogSource>> source = LogSource::Open(path, config);
  if (!source) return ExitWith(ExitCode::kUnreadable, source.error().message);
  const std::string page = FindPage(config.viewer.page_folder);
  LogViewer viewer(config, page, source->get());
  if (const Result<void> listening = viewer.Listen(); !listening)
    return ExitWith(ExitCode::kUsage, listening.error().message);
  TellAddress(page, viewer.address());
  (*source)->Start();
  viewer.Run(context.stop);
  return {};
}

Outcome Serve(ProcessContext& context, const VismapConfig& config) {
  const std::string page = FindPage(config.viewer.page_folder);
  BusOptions pictures{context.options.lcm_url, context.options.name + "-pictures", 0, &context.stop,
                      context.options.channel_prefix};
  MapViewer viewer(config.viewer, std::move(pictures), page, context.bus, context.status);
  if (const Result<void> listening = viewer.Listen(); !listening)
    return ExitWith(ExitCode::kUsage, listening.error().message);
  TellAddress(page, viewer.address());
  context.status->Set(ProcessState::kReady);
  viewer.Run(context.stop);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  VismapConfig config;
  std::optional<std::string> log;
  ThreadOption threads;
  ProcessSpec spec;
  spec.name = "viewer";
  spec.summary =
      "Serves a web page that shows the live map: surface, objects, free space, cameras, "
      "processes; or the map of a log as it was at any moment.";
  spec.add_options = [&](CommandLine& line) {
    line.Option("--bind", &config.viewer.listen,
                "ADDRESS:PORT for browsers; 127.0.0.1 = this computer alone, 0.0.0.0 = all "
                "computers of the network; port 0 = any free one");
    line.Option("--page", &config.viewer.page_folder, "Folder of the page, with index.html");
    line.Option("--max-clients", &config.viewer.max_clients,
                "Pages that may be connected at the same time")
        .AtLeast(1);
    line.Option("--log", &log,
                "Log of LCM messages, or another sequence that vismap-offline-mapper can map: it "
                "is mapped without a bus, and the page has a timeline");
    threads.AddTo(line);
  };
  UseConfig(&config, &spec);
  spec.prepare = [&]() -> Outcome {
    spec.joins_bus = !log;
    return {};
  };
  spec.run = [&](ProcessContext& context) {
    const std::unique_ptr<ThreadLimit> limit = threads.Limit();
    return log ? ServeLog(context, config, *log) : Serve(context, config);
  };
  return RunProcess(argc, argv, spec);
}
