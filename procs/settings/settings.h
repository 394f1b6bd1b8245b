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

// Shared by the processes that use a vismap config file.

/// Fills read_config and check_config of the spec, so that --config and the command line set
/// `config`.
void UseConfig(VismapConfig* config, ProcessSpec* spec);

/// Reads and checks the text of a config file (empty = defaults).
Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config);

/// Checks a config that the command line may have changed, and returns it as text with all keys.
Result<std::string> CheckConfig(const VismapConfig& config);

/// The option --threads N, which limits the parallel loops of a process as long as the limit
/// exists.
class ThreadOption {
 public:
  void AddTo(CommandLine& line);
  /// The limit that the user has set; nullptr when all processors may be used.
  std::unique_ptr<ThreadLimit> Limit() const;

 private:
  int threads_ = 0;
};

/// The parts of a config for building a map, and for computing the results of a map.
MapSessionOptions SessionOptionsOf(const VismapConfig& config);
OutputOptions OutputOptionsOf(const VismapConfig& config);

}  // namespace vismap
