#include "freespace/slice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "freespace/cell_overlaps.h"

namespace vismap {
namespace {

int32_t& Component(VoxelIndex& index, int axis) {
  return axis == 0 ? index.x : axis == 1 ? index.y : index.z;
}

// Which voxels a slice shows: cells of `step` voxels along both axes.
struct SliceFrame {
  int axis = 2;
  int64_t step = 1, layer = 0;
  std::array<int64_t, 2> first{};  // cell on each of the other axes
  std::array<int64_t, 2> count{};
};

// Enters the 64 voxels that a block has in the layer.
void EnterBlock(BlockIndex index, const BlockOccupancy& occupancy, const SliceFrame& frame,
                std::vector<uint32_t>* free_voxels, std::vector<uint8_t>* states) {
  const std::array<int, 2> others = OtherAxes(frame.axis);
  VoxelIndex first{index.x * kBlockSide, index.y * kBlockSide, index.z * kBlockSide};
  Component(first, frame.axis) = static_cast<int32_t>(frame.layer);
  for (int i = 0; i < kBlockSide * kBlockSide; ++i) {
    VoxelIndex voxel = first;
    Component(voxel, others[0]) += i % kBlockSide;
    Component(voxel, others[1]) += i / kBlockSide;
    const CellState state = occupancy.At(OffsetInBlock(voxel));
    if (state == CellState::kUnknown) continue;
    const int64_t column =
        FloorDivide<int64_t>(Component(voxel, others[0]), frame.step) - frame.first[0];
    const int64_t row =
        FloorDivide<int64_t>(Component(voxel, others[1]), frame.step) - frame.first[1];
    const auto cell = static_cast<size_t>(row * frame.count[0] + column);
    if (state == CellState::kOccupied || ++(*free_voxels)[cell] == frame.step * frame.step)
      (*states)[cell] = static_cast<uint8_t>(state);
  }
}

// Walks the blocks of the layer, so that the cost does not grow with the area.
std::vector<uint8_t> StatesOf(const OccupancyMap& map, const SliceFrame& frame) {
  const auto cells = static_cast<size_t>(frame.count[0] * frame.count[1]);
  std::vector<uint8_t> states(cells, static_cast<uint8_t>(CellState::kUnknown));
  std::vector<uint32_t> free_voxels(cells, 0);
  const int64_t layer = FloorDivide<int64_t>(frame.layer, kBlockSide);
  map.blocks().ForEach([&](BlockIndex index, const BlockOccupancy& occupancy) {
    const std::array<int32_t, 3> place = {index.x, index.y, index.z};
    if (place[static_cast<size_t>(frame.axis)] == layer)
      EnterBlock(index, occupancy, frame, &free_voxels, &states);
  });
  return states;
}

// Lays the cells over what is known of the map. Returns the cells of the longer side.
int64_t CoverKnown(OccupancyBox known, SliceFrame* frame) {
  const std::array<int, 2> others = OtherAxes(frame->axis);
  for (size_t i = 0; i < 2; ++i) {
    frame->first[i] = FloorDivide<int64_t>(Component(known.min, others[i]), frame->step);
    const int64_t last = FloorDivide<int64_t>(Component(known.max, others[i]) - 1, frame->step);
    frame->count[i] = last - frame->first[i] + 1;
  }
  return std::max(frame->count[0], frame->count[1]);
}

std::string TooFine(const OccupancyBox& known, SliceFrame frame, double voxel) {
  const double asked = static_cast<double>(frame.step) * voxel;
  const int64_t cells = CoverKnown(known, &frame);
  while (CoverKnown(known, &frame) > kMostSliceSide) ++frame.step;
  return "res: a slice has at most " + std::to_string(kMostSliceSide) +
         " cells along each side, and with cells of " + std::to_string(asked) + " m it has " +
         std::to_string(cells) +
         "; res=" + std::to_string(static_cast<double>(frame.step) * voxel) + " fits";
}

}  // namespace

Result<Slice> CutSlice(const OccupancyMap& map, const SliceQuestion& question, size_t max_cells) {
  Slice slice;
  const double voxel = map.cell_size();
  SliceFrame frame{question.axis,
                   std::max<int64_t>(1, std::llround(question.cell_m / voxel)),
                   static_cast<int64_t>(std::floor(question.at_m / voxel)),
                   {},
                   {}};
  slice.layer = frame.layer;
  slice.cell_m = static_cast<double>(frame.step) * voxel;
  const std::optional<OccupancyBox> known = map.KnownCells();
  if (!known || std::abs(frame.layer) > INT32_MAX / 2) return slice;
  for (;; frame.step *= 2) {
    const int64_t longest = CoverKnown(*known, &frame);
    if (longest > kMostSliceSide && question.cell_m > 0) return Fail(TooFine(*known, frame, voxel));
    const double cells = static_cast<double>(frame.count[0]) * static_cast<double>(frame.count[1]);
    if (longest <= kMostSliceSide && cells <= static_cast<double>(max_cells)) break;
  }
  slice.cell_m = static_cast<double>(frame.step) * voxel;
  slice.width = static_cast<int>(frame.count[0]);
  slice.height = static_cast<int>(frame.count[1]);
  for (size_t i = 0; i < 2; ++i)
    slice.origin_m[i] = static_cast<double>(frame.first[i]) * slice.cell_m;
  slice.states = StatesOf(map, frame);
  return slice;
}

}  // namespace vismap
