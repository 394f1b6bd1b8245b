#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "runtime/bus.h"
#include "runtime/command_line.h"
#include "runtime/log.h"
#include "runtime/service_manager.h"
#include "runtime/status.h"
#include "runtime/stop_signal.h"

namespace vismap {

/// Why a process fails: its exit code and a sentence for the log.
struct ExitFailure {
  ExitCode code = ExitCode::kFailed;
  std::string message;
};
using Outcome = tl::expected<void, ExitFailure>;

/// `return ExitWith(ExitCode::kUnreadable, error.message);`
inline tl::unexpected<ExitFailure> ExitWith(ExitCode code, std::string message) {
  return tl::unexpected<ExitFailure>(ExitFailure{code, std::move(message)});
}

/// The options of every program.
struct CommonOptions {
  std::string lcm_url = DefaultLcmUrl();
  std::string name;             ///< of this instance on the bus; "" = the name of the program
  double connect_timeout = 10;  ///< longest wait for the hub [s]
  std::string config_path;      ///< --config; "" = not given
  std::string channel_prefix;   ///< of our channels on the bus and in logs
};

/// The objects that the work of a process uses.
struct ProcessContext {
  const CommonOptions& options;
  StopSignal& stop;          ///< requested by SIGINT or SIGTERM
  ServiceManager& service;   ///< `status` updates it; without `status` the process does
  Bus* bus = nullptr;        ///< nullptr if the spec has joins_bus = false
  Status* status = nullptr;  ///< nullptr if `bus` is
};

/// Describes one program: its name, its options, and its work. See RunProcess.
struct ProcessSpec {
  std::string name;       ///< without "vismap-", for example "depth-segmenter"
  std::string summary;    ///< one sentence for --help
  bool joins_bus = true;  ///< false: `run` gets no bus, but may open one with OpenBus

  /// Where the config of the program keeps the prefix of our channels, which --channel-prefix
  /// overrides; nullptr = it has no config.
  std::string* channel_prefix = nullptr;

  /// Adds the options of this program; may be empty.
  std::function<void(CommandLine&)> add_options;

  /// Reads the text of the --config file ("" = none was given) into the variables of the program.
  /// The values of the command line are written before it and again after it, so that they override
  /// the config. An error is a usage error. If empty, --config is an error.
  std::function<Result<void>(const std::string& text, const std::string& path)> read_config;

  /// Checks the config after both were read, and returns it as text for --print-config. An error is
  /// a usage error. May be empty.
  std::function<Result<std::string>()> check_config;

  /// Opens the input before the process connects to the bus, so that a missing file is reported
  /// immediately. May be empty.
  std::function<Outcome()> prepare;

  /// The work. Returns when it is done or when the stop of the context is requested.
  std::function<Outcome(ProcessContext&)> run;
};

/// Runs a program: handles the common options (--help, --version, --config, --print-config,
/// --lcm-url, --channel-prefix, --name, --connect-timeout, --log-level), the log, signals, the bus,
/// the status, the service manager and exceptions. Returns the exit code for main: 0 success, 1
/// failure, 2 wrong usage or config, 3 unreadable input.
int RunProcess(int argc, char** argv, const ProcessSpec& spec);

/// Connects to the bus with the common options, for programs that do not always need it. `source`
/// is the name on the bus.
Result<std::unique_ptr<Bus>> OpenBus(const CommonOptions& options, const std::string& source,
                                     const StopSignal* stop);

}  // namespace vismap
