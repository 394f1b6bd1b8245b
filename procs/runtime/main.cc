#include "runtime/main.h"

#include <malloc.h>

#include <cstdio>
#include <exception>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "runtime/version.h"

namespace vismap {
namespace {

/// Keeps freed memory in the process, because the next frame or message needs it again. By default
/// the C library returns it to the system when the end of the heap is free, and gets it back page
/// by page, which sometimes doubles the cost of an update.
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
  LogFormat log_format = LogFormat::kText;
};

void AddCommonOptions(CommandLine& line, Arguments* arguments, std::string* channel_prefix) {
  CommonOptions& common = arguments->common;
  line.Option("--lcm-url", &common.lcm_url,
              "URL of the bus: tcpq://A.B.C.D:PORT of a vismap-hub, or udpm://...; if not given, "
              "$LCM_DEFAULT_URL");
  line.Option("--channel-prefix", channel_prefix,
              "Stands before the names of vismap's channels: with vismap/ the channel OCTOMAP is "
              "vismap/OCTOMAP; all processes of a pipeline need the same");
  line.Option("--name", &common.name, "Name of this instance on the bus");
  line.Option("--connect-timeout", &common.connect_timeout, "Longest wait for the hub [s]")
      .AtLeast(0);
  line.Option("--config", &common.config_path,
              "Read options from this file (protobuf text, .txtpb)");
  line.Flag("--print-config", &arguments->print_config, "Print the effective config and exit");
  line.Choice("--log-level", &arguments->log_level,
              {{"debug", LogLevel::kDebug},
               {"info", LogLevel::kInfo},
               {"warning", LogLevel::kWarning},
               {"error", LogLevel::kError}},
              "Lowest level of log messages to write");
  line.Choice("--log-format", &arguments->log_format,
              {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
              "json: one object per line, with level and message");
}

Result<std::string> ReadConfig(const std::string& path) {
  if (path.empty()) return std::string();
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, 1 << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

// Reads the config file, lets the command line win, and returns what holds then.
Result<std::string> Configure(const ProcessSpec& spec, const CommandLine& line,
                              const CommonOptions& options) {
  if (!spec.read_config && !options.config_path.empty())
    return Fail("--config: vismap-" + spec.name + " does not use a config file");
  if (spec.read_config) {
    const Result<std::string> text = ReadConfig(options.config_path);
    if (!text) return text;
    const Result<void> read = spec.read_config(*text, options.config_path);
    if (!read) return tl::unexpected(read.error());
    line.Apply();
  }
  return spec.check_config ? spec.check_config() : Result<std::string>("");
}

int Report(const Outcome& outcome) {
  if (outcome) return static_cast<int>(ExitCode::kOk);
  LogError(outcome.error().message);
  return static_cast<int>(outcome.error().code);
}

// A frame that had arrived and was not handled would otherwise be lost without a word.
void TellUnhandled(Bus* bus) {
  constexpr double kTimeout = 0.5;  // [s]
  for (const auto& [channel, count] : bus->CountUnhandled(kTimeout)) {
    if (channel != kRgbdFrameChannel.name && channel != kSegmentedFrameChannel.name &&
        channel != kDetectionsChannel.name)
      continue;
    LogWarning("stopped before " + FormatCount(count, "message") + " of " + channel +
               " that had arrived " + (count == 1 ? "was" : "were") + " handled");
  }
}

Outcome RunOnBus(const ProcessSpec& spec, const CommonOptions& options, StopSignal* stop,
                 ServiceManager* service) {
  service->SetStatus("starting: connecting to the bus at " + options.lcm_url);
  const Result<std::unique_ptr<Bus>> bus = OpenBus(options, options.name, stop);
  if (!bus) {
    if (stop->requested()) return {};
    return ExitWith(ExitCode::kFailed, bus.error().message);
  }
  Status status(bus->get(), spec.name, service);
  ProcessContext context{options, *stop, *service, bus->get(), &status};
  const Outcome outcome = spec.run(context);
  TellUnhandled(bus->get());
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
    return ExitWith(ExitCode::kFailed,
                    std::string("internal error (please report it): ") + error.what());
  }
}

}  // namespace

Result<std::unique_ptr<Bus>> OpenBus(const CommonOptions& options, const std::string& source,
                                     const StopSignal* stop) {
  return Bus::Open(
      {options.lcm_url, source, options.connect_timeout, stop, options.channel_prefix});
}

int RunProcess(int argc, char** argv, const ProcessSpec& spec) {
  KeepFreedMemory();
  CommandLine line("vismap-" + spec.name, spec.summary, Version());
  Arguments arguments;
  arguments.common.name = spec.name;
  std::string* const channel_prefix =
      spec.channel_prefix != nullptr ? spec.channel_prefix : &arguments.common.channel_prefix;
  AddCommonOptions(line, &arguments, channel_prefix);
  if (spec.add_options) spec.add_options(line);
  if (const std::optional<ExitCode> end = line.Parse(argc, argv)) return static_cast<int>(*end);
  line.Apply();
  if (arguments.common.name.empty()) arguments.common.name = spec.name;
  SetUpLog(arguments.common.name, arguments.log_level, arguments.log_format);

  const Result<std::string> config = Configure(spec, line, arguments.common);
  if (!config) return Report(ExitWith(ExitCode::kUsage, config.error().message));
  arguments.common.channel_prefix = *channel_prefix;
  if (const auto checked = CheckChannelPrefix(*channel_prefix); !checked) {
    return Report(ExitWith(ExitCode::kUsage,
                           "pipeline.channel_prefix (--channel-prefix): " + checked.error().message));
  }
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
