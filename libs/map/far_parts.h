#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "map/block.h"
#include "map/map_metadata.h"

namespace vismap {

/// The parts of a map that lie far from the rest of it and that few frames made: most often the
/// poses of these frames were wrong. They stay in the map, but what is made of all of it leaves
/// them out, since they would make pictures and bounds useless.
///
/// Space is cut into cubes of 20 m. Cubes in which cameras were form one part when they touch each
/// other, also at corners. A part is far when it has less than a tenth of the frames of the largest
/// part, or fewer than ten frames and less than half of them.
class FarParts {
 public:
  /// No part is far.
  FarParts() = default;
  /// Of the map that these frames made.
  explicit FarParts(const std::vector<CameraPose>& trajectory);

  bool empty() const { return cubes_.empty(); }
  /// Whether a point [m] lies in such a part: in a cube in which a camera of it was, or in one
  /// beside it, unless a camera of another part was as near.
  bool Contains(const Eigen::Vector3d& p_W) const;
  /// How many frames made them.
  int64_t frames() const { return frames_; }
  /// One sentence about them; nullopt when there are none.
  std::optional<std::string> Sentence() const;

  friend bool operator==(const FarParts&, const FarParts&) = default;

 private:
  std::set<BlockIndex> cubes_;  // index of each cube that belongs to them
  int64_t frames_ = 0, all_frames_ = 0;
};

}  // namespace vismap
