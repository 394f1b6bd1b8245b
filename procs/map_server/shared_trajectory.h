#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "map/map_metadata.h"

namespace vismap {

/// The trajectory of a map that grows, of which a copy takes little time: all but the newest poses
/// are shared by copies, and never changed.
class SharedTrajectory {
 public:
  /// Takes over the poses that it lacks, of a trajectory that begins with those that it has.
  void Follow(const std::vector<CameraPose>& trajectory);
  size_t size() const { return kChunk * full_.size() + newest_.size(); }
  /// All poses, in their order.
  std::vector<CameraPose> Collect() const;

 private:
  static constexpr size_t kChunk = 256;  // poses

  std::vector<std::shared_ptr<const std::vector<CameraPose>>> full_;  // chunks
  std::vector<CameraPose> newest_;                                    // less than a chunk
};

}  // namespace vismap
