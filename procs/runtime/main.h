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

/// Why a process ends other than well: its exit code and a sentence for the log.
struct ExitFailure {
  ExitCode code = ExitCode::kFailed;
  std::string message;
};
using Outcome = tl::expected<void, ExitFailure>;

/// `return ExitWith(ExitCode::kUnreadable, error.message);`
inline tl::unexpected<ExitFailure> ExitWith(ExitCode code, std::string message) {
  return tl::unexpected<ExitFailure>(ExitFailure{code, std::move(message)});
}

/// Options that every process has.
struct CommonOptions {
  std::string lcm_url = DefaultLcmUrl();
  std::string name;             ///< of this instance on the bus; empty = the program's
  double connect_timeout = 10;  ///< [s]
  std::string config_path;      ///< --config; empty = none given
};

/// What a process has to work with while it runs.
struct ProcessContext {
  const CommonOptions& options;
  StopSignal& stop;          ///< SIGINT or SIGTERM came
  ServiceManager& service;   ///< hears of `status` by itself; those without one tell it
  Bus* bus = nullptr;        ///< none when the spec says so
  Status* status = nullptr;  ///< goes with bus
};

/// One program: its name, its options, its work. See RunProcess.
struct ProcessSpec {
  std::string name;       ///< without "vismap-", for example "depth-segmenter"
  std::string summary;    ///< one sentence for --help
  bool joins_bus = true;  ///< false: `run` gets no bus; it may open one with OpenBus

  /// Adds the program's own options and flags; may be empty.
  std::function<void(CommandLine&)> add_options;

  /// Reads the text of the --config file (empty = none was given) into the variables of the
  /// program. The values of the command line are written before, and again afterwards, so that they
  /// win. An error is a usage error. May be empty: then --config is refused.
  std::function<Result<void>(const std::string& text, const std::string& path)> read_config;

  /// Checks the config after both were read, and returns it as text for --print-config. An error is
  /// a usage error. May be empty.
  std::function<Result<std::string>()> check_config;

  /// Opens what the work reads, before the bus is joined, so that a missing file shows at once. May
  /// be empty.
  std::function<Outcome()> prepare;

  /// The work. Comes back when done or when the context's stop is requested.
  std::function<Outcome(ProcessContext&)> run;
};

/// Everything around the work of a process: the options --help --version --config --print-config
/// --lcm-url --name --connect-timeout --log-level, the log, signals, the bus, the status, the
/// service manager, exceptions. Returns the exit code for main: 0 well, 1 failed, 2 wrong usage or
/// config, 3 unreadable input.
int RunProcess(int argc, char** argv, const ProcessSpec& spec);

/// Joins the bus as the common options say; for programs that do not always need it. `source` =
/// name on the bus.
Result<std::unique_ptr<Bus>> OpenBus(const CommonOptions& options, const std::string& source,
                                     const StopSignal* stop);

}  // namespace vismap
