#include "map/far_parts.h"

#include <algorithm>
#include <map>

namespace vismap {
namespace {

constexpr double kCubeSide = 20;  // [m]
constexpr int64_t kFewFrames = 10;
constexpr double kSmallShare = 0.1, kSmallShareOfFew = 0.5;  // of the frames of the largest part

BlockIndex CubeAround(const Eigen::Vector3d& p_W) {
  constexpr double kMost = 1e8;  // poses of a damaged file may be anything
  const Eigen::Vector3i index =
      (p_W / kCubeSide).array().floor().max(-kMost).min(kMost).cast<int>();
  return {index.x(), index.y(), index.z()};
}

template <typename Visit>
void ForEachNeighbour(BlockIndex cube, const Visit& visit) {
  for (int i = 0; i < 27; ++i)
    visit(BlockIndex{cube.x + i % 3 - 1, cube.y + i / 3 % 3 - 1, cube.z + i / 9 - 1});
}

struct Part {
  std::vector<BlockIndex> cubes;
  int64_t frames = 0;
};

// Removes the part of a cube from `frames`, the number of frames in each cube.
Part TakePart(BlockIndex cube, std::map<BlockIndex, int64_t>* frames) {
  Part part;
  std::vector<BlockIndex> open{cube};
  while (!open.empty()) {
    const BlockIndex next = open.back();
    open.pop_back();
    const auto found = frames->find(next);
    if (found == frames->end()) continue;
    part.frames += found->second;
    part.cubes.push_back(next);
    frames->erase(found);
    ForEachNeighbour(next, [&](BlockIndex neighbour) { open.push_back(neighbour); });
  }
  return part;
}

bool IsSmall(int64_t frames, int64_t largest) {
  const double share = static_cast<double>(frames) / static_cast<double>(largest);
  return share < kSmallShare || (frames < kFewFrames && share < kSmallShareOfFew);
}

}  // namespace

FarParts::FarParts(const std::vector<CameraPose>& trajectory) {
  all_frames_ = static_cast<int64_t>(trajectory.size());
  std::map<BlockIndex, int64_t> frames;
  for (const CameraPose& pose : trajectory) ++frames[CubeAround(pose.T_W_C.translation())];
  std::vector<Part> parts;
  int64_t largest = 0;
  while (!frames.empty()) {
    parts.push_back(TakePart(frames.begin()->first, &frames));
    largest = std::max(largest, parts.back().frames);
  }
  for (const Part& part : parts) {
    if (!IsSmall(part.frames, largest)) continue;
    frames_ += part.frames;
    for (const BlockIndex& cube : part.cubes)
      ForEachNeighbour(cube, [&](BlockIndex neighbour) { cubes_.insert(neighbour); });
  }
  for (const Part& part : parts) {
    if (IsSmall(part.frames, largest)) continue;
    for (const BlockIndex& cube : part.cubes)
      ForEachNeighbour(cube, [&](BlockIndex neighbour) { cubes_.erase(neighbour); });
  }
}

bool FarParts::Contains(const Eigen::Vector3d& p_W) const {
  return !empty() && cubes_.contains(CubeAround(p_W));
}

std::optional<std::string> FarParts::Sentence() const {
  if (empty()) return std::nullopt;
  return std::to_string(frames_) + " of " + std::to_string(all_frames_) +
         " frames were taken far from all others (more than 20 m); what they show is left out of "
         "meshes, objects, pictures and octrees. Their poses are probably wrong";
}

}  // namespace vismap
