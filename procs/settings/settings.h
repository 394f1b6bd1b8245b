#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "config/config.h"
#include "exports/outputs.h"
#include "runtime/main.h"
#include "session/map_session.h"

namespace vismap {

// What the processes that take a vismap config file share.

/// Lets `config` be what --config and the options of the command line say: fills read_config and
/// check_config of the spec.
void UseConfig(VismapConfig* config, ProcessSpec* spec);

/// Reads and checks the text of a config file (empty = defaults).
Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config);

/// Checks a config that the command line may have changed, and returns it in full.
Result<std::string> CheckConfig(const VismapConfig& config);

/// `--threads N`: limits the parallel loops of the process while the limit lives.
class ThreadOption {
 public:
  void AddTo(CommandLine& line);
  /// The limit that the user asked for; none when all processors may be used.
  std::unique_ptr<ThreadLimit> Limit() const;

 private:
  int threads_ = 0;
};

/// The parts of a config that a map is made with, and what is made of the map.
MapSessionOptions SessionOptionsOf(const VismapConfig& config);
OutputOptions OutputOptionsOf(const VismapConfig& config);

}  // namespace vismap
