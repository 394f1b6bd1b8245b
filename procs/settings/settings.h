#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "config/config.h"
#include "datasets/dataset.h"
#include "runtime/main.h"

namespace vismap {

// Shared by the processes that use a vismap config file.

/// Fills read_config, check_config and channel_prefix of the spec, so that --config and the command
/// line set `config`. `check` is called after both were read, for further checks.
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

/// The options --intrinsics, --depth-unit and --depth-registration, which replace what a recorded
/// sequence states about its depth images.
class CalibrationOptions {
 public:
  void AddTo(CommandLine& line);
  /// Sets them in `options`. Fails when --intrinsics has not four numbers.
  Result<void> SetIn(DatasetOptions* options) const;

 private:
  std::vector<double> intrinsics_;
  double depth_unit_m_ = 0;
  DepthRegistration registration_ = DepthRegistration::kAuto;
};

}  // namespace vismap
