#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vismap {

/// Simulates a lossy network, for tests.
struct FaultOptions {
  double drop_fraction = 0;  ///< share of the published messages that is lost, in [0, 1]
  int64_t seed = 0;          ///< seed of the random choice
  /// Lose messages of these channels only; empty = all channels.
  std::vector<std::string> channels;
};

/// Chooses the messages that a hub loses intentionally. The choice depends on the seed and on the
/// number of the message within its channel, so that a repeated run loses the same messages.
class FaultInjection {
 public:
  explicit FaultInjection(FaultOptions options);

  /// Whether the next message of this channel must be lost.
  bool Drops(const std::string& channel);

 private:
  FaultOptions options_;
  std::map<std::string, uint64_t> counts_;  // messages so far, per channel
};

}  // namespace vismap
