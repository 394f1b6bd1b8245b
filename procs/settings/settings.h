#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "config/config.h"
#include "exports/outputs.h"
#include "session/map_session.h"

namespace CLI {
class App;
}

namespace vismap {

// What the processes that take a vismap config file share.

/// For ProcessSpec::configure: reads and checks the config text (empty = defaults) into `config`;
/// returns it in full.
Result<std::string> TakeConfig(const std::string& text, const std::string& path,
                               VismapConfig* config);

/// `--threads N`: limits the parallel loops of the process while the limit lives.
class ThreadOption {
 public:
  void AddTo(CLI::App& app);
  /// The limit that the user asked for; none when all processors may be used.
  std::unique_ptr<ThreadLimit> Limit() const;

 private:
  int threads_ = 0;
};

/// The parts of a config that a map is made with, and what is made of the map.
MapSessionOptions SessionOptionsOf(const VismapConfig& config);
OutputOptions OutputOptionsOf(const VismapConfig& config);

}  // namespace vismap
