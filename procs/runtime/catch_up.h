#pragma once

#include <string>

#include "runtime/bus.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Requests missing updates from the map server, for a process that keeps a copy of the map.
class CatchUp {
 public:
  /// `verb` is that of the MAP_REQUEST: "snapshot" for MAP_DELTA, "mesh" for MESH_DELTA.
  CatchUp(Bus* bus, std::string verb) : bus_(bus), verb_(std::move(verb)) {}

  /// Requests all updates after `position`. Does nothing within two seconds after the last request,
  /// so that it may be called again until the updates arrive.
  void Request(const FollowerPosition& position);

 private:
  Bus* bus_;
  std::string verb_;
  double next_request_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
