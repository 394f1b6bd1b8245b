#include "runtime/main.h"

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <utility>

#include "base/file.h"
#include "runtime/version.h"

namespace vismap {
namespace {

/// What one frame or message frees, the next needs again. Without this the C library gives it back
/// to the system, whenever the end of the heap happens to be free, and gets it again page by page:
/// a viewer's updates then cost twice as much, or not, by chance.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kKept = 32 << 20;  // [bytes]
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kKept);
#endif
}

struct Arguments {
  CommonOptions common;
  bool print_config = false;
  LogLevel log_level = LogLevel::kInfo;
};

void AddCommonOptions(CLI::App* app, const ProcessSpec& spec, Arguments* arguments) {
  app->set_version_flag("--version", std::string("vismap-") + spec.name + " " + Version(),
                        "Print the version and exit");
  app->add_option(
      "--lcm-url", arguments->common.lcm_url,
      "The bus: tcpq://A.B.C.D:PORT of a vismap-hub, or udpm://...; default $LCM_DEFAULT_URL, "
      "else tcpq://127.0.0.1:7700");
  app->add_option("--name", arguments->common.name, "Name of this instance on the bus")
      ->default_str(spec.name);
  app->add_option("--connect-timeout", arguments->common.connect_timeout,
                  "Seconds to wait for the hub")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app->add_option("--config", arguments->common.config_path,
                  "Options from a file, protobuf text (.txtpb)");
  app->add_flag("--print-config", arguments->print_config, "Print the effective config and exit");
  const std::map<std::string, LogLevel> levels = {{"debug", LogLevel::kDebug},
                                                  {"info", LogLevel::kInfo},
                                                  {"warning", LogLevel::kWarning},
                                                  {"error", LogLevel::kError}};
  app->add_option("--log-level", arguments->log_level,
                  "debug, info, warning or error; default info")
      ->transform(CLI::CheckedTransformer(levels))
      ->option_text("LEVEL");
}

Result<std::string> ReadConfig(const std::string& path) {
  if (path.empty()) return std::string();
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, 1 << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

Result<std::string> Configure(const ProcessSpec& spec, const CommonOptions& options) {
  if (!spec.configure) {
    if (!options.config_path.empty())
      return Fail("--config: vismap-" + spec.name + " takes no config file");
    return std::string();
  }
  const Result<std::string> text = ReadConfig(options.config_path);
  if (!text) return text;
  return spec.configure(*text, options.config_path);
}

int Report(const Outcome& outcome) {
  if (outcome) return static_cast<int>(ExitCode::kOk);
  LogError(outcome.error().message);
  return static_cast<int>(outcome.error().code);
}

Outcome RunOnBus(const ProcessSpec& spec, const CommonOptions& options, StopSignal* stop,
                 ServiceManager* service) {
  service->Say("starting: joining the bus at " + options.lcm_url);
  const Result<std::unique_ptr<Bus>> bus = OpenBus(options, options.name, stop);
  if (!bus) {
    if (stop->requested()) return {};
    return ExitWith(ExitCode::kFailed, bus.error().message);
  }
  Status status(bus->get(), spec.name, service);
  ProcessContext context{options, *stop, *service, bus->get(), &status};
  const Outcome outcome = spec.run(context);
  status.Set(ProcessState::kStopping, outcome ? "" : outcome.error().message);
  return outcome;
}

Outcome RunGuarded(const ProcessSpec& spec, const CommonOptions& options, StopSignal* stop) {
  ServiceManager service;
  try {
    if (spec.prepare) {
      if (Outcome prepared = spec.prepare(); !prepared) return prepared;
    }
    if (spec.joins_bus) return RunOnBus(spec, options, stop, &service);
    ProcessContext context{options, *stop, service};
    return spec.run(context);
  } catch (const std::exception& error) {
    return ExitWith(ExitCode::kFailed, std::string("this is a bug: ") + error.what());
  }
}

}  // namespace

Result<std::unique_ptr<Bus>> OpenBus(const CommonOptions& options, const std::string& source,
                                     const StopSignal* stop) {
  return Bus::Open({options.lcm_url, source, options.connect_timeout, stop});
}

int RunProcess(int argc, char** argv, const ProcessSpec& spec) {
  KeepFreedMemory();
  CLI::App app(spec.summary, "vismap-" + spec.name);
  Arguments arguments;
  AddCommonOptions(&app, spec, &arguments);
  if (spec.add_options) spec.add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? static_cast<int>(ExitCode::kOk)
                                : static_cast<int>(ExitCode::kUsage);
  }
  if (arguments.common.name.empty()) arguments.common.name = spec.name;
  SetUpLog(arguments.common.name, arguments.log_level);

  const Result<std::string> config = Configure(spec, arguments.common);
  if (!config) return Report(ExitWith(ExitCode::kUsage, config.error().message));
  if (arguments.print_config) {
    std::fputs(config->c_str(), stdout);
    return static_cast<int>(ExitCode::kOk);
  }
  if (const Result<LcmUrl> url = ParseLcmUrl(arguments.common.lcm_url); !url) {
    return Report(ExitWith(ExitCode::kUsage, url.error().message));
  }
  StopSignal stop;
  StopSignal::InstallHandlers(&stop);
  return Report(RunGuarded(spec, arguments.common, &stop));
}

}  // namespace vismap
