#pragma once

#include <map>
#include <string>

namespace vismap {

enum class BridgeSide { kLocal, kRemote };

/// Which side of a bridge every source of messages lives on: where it was heard first. What a
/// bridge passes on comes back to it from the other side; by this it knows not to return it.
class SourceSides {
 public:
  /// Whether a message of `source` heard on `side` comes from there; `now` [s]. A source that has
  /// been silent on its side for half a minute may turn up on the other. False, too, for new
  /// sources beyond some thousands.
  bool LivesOn(BridgeSide side, const std::string& source, double now);

 private:
  struct Home {
    BridgeSide side;
    double last_heard = 0;
  };
  std::map<std::string, Home> homes_;
};

}  // namespace vismap
