#include "evaluation/free_space.h"

#include <utility>

#include "evaluation/nearest.h"
#include "rectify/rectifier.h"

namespace vismap {
namespace {

// Adds the samples along the rays of one depth image.
void AddFrame(const OccupancyMap& map, const SensorFrame& frame, const RayOptions& options,
              RayScore* score) {
  const PinholeCamera& camera = frame.header.camera;
  const int first = options.pixel_step / 2;
  const bool floats = frame.depth.empty();
  for (int v = first; v < camera.height; v += options.pixel_step) {
    for (int u = first; u < camera.width; u += options.pixel_step) {
      const double z =
          floats ? double{frame.depth_m(v, u)} : frame.depth(v, u) * frame.depth_unit_m;
      if (!(z >= options.min_depth && z <= options.max_depth)) continue;  // none, or out of range
      const Eigen::Vector3d ray_C((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
      const double stretch = ray_C.norm();  // distance from the camera divided by depth
      for (double r = options.first; r < z * stretch - options.margin; r += options.step)
        score->free.Add(map.At(frame.header.T_W_C * (ray_C * (r / stretch))));
      score->surface.Add(map.At(frame.header.T_W_C * (ray_C * z)));
    }
  }
}

}  // namespace

void CellShares::Add(CellState state) {
  ++samples;
  ++(state == CellState::kFree ? free : state == CellState::kOccupied ? occupied : unknown);
}

CellShares CellsAt(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W) {
  CellShares shares;
  for (const Eigen::Vector3f& p_W : points_W)
    shares.Add(map.At(Eigen::Vector3d(p_W.cast<double>())));
  return shares;
}

OccupiedCells CountOccupied(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W,
                            double margin) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(points_W.size());
  for (const Eigen::Vector3f& p_W : points_W) points.push_back(p_W.cast<double>());
  const NearestPoints truth(std::move(points));
  OccupiedCells cells;
  for (const BlockIndex& index : map.SortedIndices()) {
    const BlockOccupancy& block = map.At(index);
    // The block has no occupied cell.
    if (block.is(CellState::kFree) || block.is(CellState::kUnknown)) continue;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      if (block.At(offset) != CellState::kOccupied) continue;
      const Eigen::Vector3d cell(index.x * kBlockSide + offset % kBlockSide,
                                 index.y * kBlockSide + offset / kBlockSide % kBlockSide,
                                 index.z * kBlockSide + offset / (kBlockSide * kBlockSide));
      const auto nearest = truth.Nearest((cell.array() + 0.5) * map.cell_size());
      ++cells.cells;
      cells.far_from_truth += !nearest || nearest->distance > margin;
    }
  }
  return cells;
}

Result<RayScore> ScoreRays(const OccupancyMap& map, const Dataset& dataset,
                           const RayOptions& options) {
  RayScore score;
  Rectifier rectifier;
  for (size_t i = 0; i < dataset.size(); i += options.frame_step) {
    Result<SensorFrame> frame = dataset.Read(i);
    if (frame) frame = rectifier.Rectify(std::move(*frame));
    if (frame) AddFrame(map, *frame, options, &score);  // the mapper left out the others, too
  }
  return score;
}

}  // namespace vismap
