#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vismap/object_list_t.hpp>

#include "base/result.h"

namespace vismap {

/// Which way is up in a map, as the map server has found: the third axis of the boxes on OBJECTS.
class MapUp {
 public:
  /// Z of the map may be off by so much for a grid [degrees].
  static constexpr double kMostTilt = 20;

  /// Fails on a damaged list.
  Result<void> Hear(const object_list_t& message);

  /// Why a grid of this map would be wrong: its z does not point upward. nullopt = it does, or no
  /// object has told yet.
  std::optional<std::string> GridProblem(const std::string& map_id) const;

 private:
  std::string map_id_;
  std::optional<Eigen::Vector3d> up_W_;
};

}  // namespace vismap
