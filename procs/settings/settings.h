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

/// Fills read_config and check_config of the spec, so that --config and the command line set
/// `config`. `check` is called after both were read, for further checks.
void UseConfig(
    VismapConfig* config, ProcessSpec* spec,
    const std::function<Result<void>()>& check = [] { return Result<void>(); });

/// Reads and checks the text of a config file ("" = defaults).
Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config);

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

}  // namespace vismap
