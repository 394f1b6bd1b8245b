#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "viewer/http_rules.h"
#include "wire/update_sequence.h"

namespace vismap {

/// A plane through free space, across one axis of W.
struct SliceQuestion {
  int axis = 2;       ///< 0, 1, 2 = x, y, z
  double at_m = 0;    ///< where on this axis
  double cell_m = 0;  ///< edge of a cell of the picture; 0 = a voxel
};
/// Arguments axis=x|y|z, at=METRES and, optional, res=METRES.
Result<SliceQuestion> ReadSlice(const HttpTarget& target);

/// One byte per cell: 0 unknown, 1 free, 2 occupied, within the bounds of what is known of the
/// whole map. A cell of several voxels is occupied when one of them is, and free when all are.
struct Slice {
  double cell_m = 0;            ///< a whole number of voxels
  int64_t layer = 0;            ///< index of the voxels on the axis
  double origin_m[2] = {};      ///< corner of the first cell, on the other two axes
  int width = 0, height = 0;    ///< along the first and the second of the other axes
  std::vector<uint8_t> states;  ///< row by row, `height` rows of `width`
};
constexpr int64_t kMostSliceSide = 4096;  ///< cells
/// With more than `max_cells`, the cells get larger, and without a given size also when a side has
/// more than kMostSliceSide. Fails when a given size needs longer sides. Costs as much as the map
/// has blocks, and the 64 voxels of each block of the layer.
Result<Slice> CutSlice(const OccupancyMap& map, const SliceQuestion& question,
                       size_t max_cells = size_t{1} << 22);

/// u32 size of a JSON, the JSON, the states.
std::vector<uint8_t> EncodeSlice(const Slice& slice, const SliceQuestion& question,
                                 const FollowerPosition& position);

/// Answers GET /api/slice. Keeps the last slice, since several pages look at the same one, and cuts
/// at most 10 new ones per second.
class SliceAnswers {
 public:
  static constexpr double kMostPerSecond = 10;
  /// `now` in MonotonicSeconds.
  HttpAnswer Get(const HttpTarget& target, const OccupancyMap& map,
                 const FollowerPosition& position, double now);

 private:
  // map_id, revision, axis, layer, size of cells that was asked for
  using Key = std::tuple<std::string, int64_t, int, double, double>;
  std::optional<Key> kept_;
  Slice slice_;  // belongs to kept_
  double tokens_ = kMostPerSecond, filled_ = 0;
};

}  // namespace vismap
