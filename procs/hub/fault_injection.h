#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vismap {

/// A lossy network, for tests.
struct FaultOptions {
  double drop_fraction = 0;           ///< of the messages that clients publish, in [0, 1]
  int64_t seed = 0;                   ///< another one drops others
  std::vector<std::string> channels;  ///< only of these; empty = of all
};

/// Chooses the messages that a hub loses on purpose. Which ones depends on the seed and on the
/// place of a message among those of its channel, so that the same run loses the same ones.
class FaultInjection {
 public:
  explicit FaultInjection(FaultOptions options);

  /// Whether the next message of this channel is to be lost.
  bool Drops(const std::string& channel);

 private:
  FaultOptions options_;
  std::map<std::string, uint64_t> counts_;  // messages so far, per channel
};

}  // namespace vismap
