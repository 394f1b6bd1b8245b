#pragma once

#include <map>
#include <string>

namespace vismap {

enum class BridgeSide { kLocal, kRemote };

/// Remembers for every source of messages on which side of the bridge it lives, which is the side
/// on which it was received first. The bridge also receives the messages that it has forwarded
/// itself; it must not forward them back.
class SourceSides {
 public:
  /// Whether `source`, of which a message was received on `side` at time `now` [s], lives there. A
  /// source that was silent for half a minute may move to the other side. Returns false for new
  /// sources when too many are known.
  bool LivesOn(BridgeSide side, const std::string& source, double now);

 private:
  struct Home {
    BridgeSide side;
    double last_heard = 0;
  };
  std::map<std::string, Home> homes_;
};

}  // namespace vismap
