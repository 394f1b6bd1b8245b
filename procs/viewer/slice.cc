#include "viewer/slice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/printable.h"
#include "requests/request_argument.h"
#include "viewer/page_messages.h"

namespace vismap {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// The two axes that a slice across `axis` has.
std::array<int, 2> OtherAxes(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

int32_t& Component(VoxelIndex& index, int axis) {
  return axis == 0 ? index.x : axis == 1 ? index.y : index.z;
}

int64_t FloorDivide(int64_t a, int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

// Which voxels a slice shows: cells of `step` voxels along both axes.
struct SliceFrame {
  int axis = 2;
  int64_t step = 1, layer = 0;
  std::array<int64_t, 2> first{};  // cell on each of the other axes
  std::array<int64_t, 2> count{};
};

CellState StateOf(const OccupancyMap& map, const SliceFrame& frame, int64_t column, int64_t row) {
  const std::array<int, 2> others = OtherAxes(frame.axis);
  bool all_free = true;
  VoxelIndex voxel;
  Component(voxel, frame.axis) = static_cast<int32_t>(frame.layer);
  for (int64_t v = 0; v < frame.step; ++v) {
    Component(voxel, others[1]) = static_cast<int32_t>((frame.first[1] + row) * frame.step + v);
    for (int64_t u = 0; u < frame.step; ++u) {
      Component(voxel, others[0]) =
          static_cast<int32_t>((frame.first[0] + column) * frame.step + u);
      const CellState state = map.At(voxel);
      if (state == CellState::kOccupied) return state;
      all_free = all_free && state == CellState::kFree;
    }
  }
  return all_free ? CellState::kFree : CellState::kUnknown;
}

}  // namespace

Result<SliceQuestion> ReadSlice(const HttpTarget& target) {
  SliceQuestion question;
  for (const auto& [key, value] : target.query) {
    if (key == "axis") {
      const auto found = std::find(kAxes.begin(), kAxes.end(), value);
      if (found == kAxes.end())
        return Fail("axis: expected x, y or z, found '" + PrintableText(value, 60) + "'");
      question.axis = static_cast<int>(found - kAxes.begin());
    } else if (key == "at" || key == "res") {
      const auto number = ReadNumbersOf(key, value, 1);
      if (!number) return tl::unexpected(number.error());
      (key == "at" ? question.at_m : question.cell_m) = number->front();
    } else {
      return Fail("slice: the arguments are axis, at and res, found '" + PrintableText(key, 60) +
                  "'");
    }
  }
  if (!target.query.contains("at")) return Fail("slice: say where with at=METRES");
  if (std::abs(question.at_m) > 1e5) return Fail("at: expected at most 100000 m");
  if (question.cell_m < 0 || question.cell_m > 10) return Fail("res: expected 0 to 10 m");
  return question;
}

Slice CutSlice(const OccupancyMap& map, const SliceQuestion& question, size_t max_cells) {
  Slice slice;
  const double voxel = map.cell_size();
  SliceFrame frame{question.axis,
                   std::max<int64_t>(1, std::llround(question.cell_m / voxel)),
                   static_cast<int64_t>(std::floor(question.at_m / voxel)),
                   {},
                   {}};
  slice.layer = frame.layer;
  slice.cell_m = static_cast<double>(frame.step) * voxel;
  std::optional<OccupancyBox> known = map.KnownCells();
  if (!known || std::abs(frame.layer) > INT32_MAX / 2) return slice;
  const std::array<int, 2> others = OtherAxes(question.axis);
  for (;; frame.step *= 2) {
    for (size_t i = 0; i < 2; ++i) {
      frame.first[i] = FloorDivide(Component(known->min, others[i]), frame.step);
      const int64_t last = FloorDivide(Component(known->max, others[i]) - 1, frame.step);
      frame.count[i] = last - frame.first[i] + 1;
    }
    const double cells = static_cast<double>(frame.count[0]) * static_cast<double>(frame.count[1]);
    if (cells <= static_cast<double>(max_cells)) break;
  }
  slice.cell_m = static_cast<double>(frame.step) * voxel;
  slice.width = static_cast<int>(frame.count[0]);
  slice.height = static_cast<int>(frame.count[1]);
  for (size_t i = 0; i < 2; ++i)
    slice.origin_m[i] = static_cast<double>(frame.first[i]) * slice.cell_m;
  slice.states.reserve(static_cast<size_t>(frame.count[0] * frame.count[1]));
  for (int64_t row = 0; row < frame.count[1]; ++row) {
    for (int64_t column = 0; column < frame.count[0]; ++column)
      slice.states.push_back(static_cast<uint8_t>(StateOf(map, frame, column, row)));
  }
  return slice;
}

std::vector<uint8_t> EncodeSlice(const Slice& slice, const SliceQuestion& question,
                                 const FollowerPosition& position) {
  const std::array<int, 2> others = OtherAxes(question.axis);
  const nlohmann::ordered_json json{
      {"map_id", position.map_id},
      {"revision", position.revision},
      {"axis", kAxes[static_cast<size_t>(question.axis)]},
      {"at_m", question.at_m},
      {"cell_m", slice.cell_m},
      {"origin", {slice.origin_m[0], slice.origin_m[1]}},
      {"width", slice.width},
      {"height", slice.height},
      {"axes", {kAxes[static_cast<size_t>(others[0])], kAxes[static_cast<size_t>(others[1])]}},
      {"layer", slice.layer}};
  std::vector<uint8_t> bytes =
      JsonHeader(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  bytes.insert(bytes.end(), slice.states.begin(), slice.states.end());
  return bytes;
}

}  // namespace vismap
