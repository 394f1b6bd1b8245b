#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <vismap/map_reply_t.hpp>

#include "runtime/bus.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Where the camera was when it took the frames of the map: asked for from the map server (verb
/// frames, argument positions=N), since MAP_DELTA does not say so.
class CameraPath {
 public:
  /// `wanted`: whether it asks at all. `patience`: see IsAwaited [s]. `bus` must outlive it.
  CameraPath(bool wanted, double patience, Bus* bus);

  /// Asks for the positions of the frames up to `position` that are missing, and again when no
  /// answer comes.
  void Request(const FollowerPosition& position);
  /// Whether positions have been missing for less than the patience.
  bool IsAwaited() const;

  /// Those that have come, in the order of the frames, of the map that was asked for last [m].
  const std::vector<Eigen::Vector3d>& positions_W() const { return positions_W_; }
  const std::string& map_id() const { return map_id_; }

 private:
  Result<void> OnReply(const map_reply_t& reply);

  bool wanted_;
  double patience_;  // [s]
  Bus* bus_;
  double next_request_ = 0;              // MonotonicSeconds
  std::optional<double> missing_since_;  // MonotonicSeconds; nullopt = all have come
  int64_t request_id_ = 0;               // of the last request
  std::string map_id_;
  std::vector<Eigen::Vector3d> positions_W_;
};

}  // namespace vismap
