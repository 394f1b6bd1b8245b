#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "config/config.h"
#include "runtime/main.h"

namespace vismap {

// Shared by the processes that use a vismap config file.

/// Lets `config` be what --config and the options of the command line say: fills read_config and
/// check_config of the spec. `check` = what else must hold, or must be done, after both were read.
void UseConfig(
    VismapConfig* config, ProcessSpec* spec,
    const std::function<Result<void>()>& check = [] { return Result<void>(); });

/// Reads and checks the text of a config file (empty = defaults).
Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config);

/// `--threads N`: limits the parallel loops of the process while the limit lives.
class ThreadOption {
 public:
  void AddTo(CommandLine& line);
  /// The limit that the user has set; nullptr when all processors may be used.
  std::unique_ptr<ThreadLimit> Limit() const;

 private:
  int threads_ = 0;
};

}  // namespace vismap
