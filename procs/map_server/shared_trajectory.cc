#include "map_server/shared_trajectory.h"

#include <utility>

namespace vismap {

void SharedTrajectory::Follow(const std::vector<CameraPose>& trajectory) {
  for (size_t i = size(); i < trajectory.size(); ++i) {
    newest_.push_back(trajectory[i]);
    if (newest_.size() < kChunk) continue;
    full_.push_back(std::make_shared<const std::vector<CameraPose>>(std::exchange(newest_, {})));
  }
}

std::vector<CameraPose> SharedTrajectory::Collect() const {
  std::vector<CameraPose> all;
  all.reserve(size());
  for (const auto& chunk : full_) all.insert(all.end(), chunk->begin(), chunk->end());
  all.insert(all.end(), newest_.begin(), newest_.end());
  return all;
}

}  // namespace vismap
