#pragma once

#include <string>

#include "runtime/bus.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Asks a map server for the updates that a follower lacks, and asks again until they come.
class CatchUp {
 public:
  /// `verb` of the MAP_REQUEST: "snapshot" for MAP_DELTA, "mesh" for MESH_DELTA.
  CatchUp(Bus* bus, std::string verb) : bus_(bus), verb_(std::move(verb)) {}

  /// Asks for all after `position`, unless it did so in the last two seconds.
  void Request(const FollowerPosition& position);

 private:
  Bus* bus_;
  std::string verb_;
  double next_request_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
