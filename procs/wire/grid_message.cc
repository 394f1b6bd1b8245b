#include "wire/grid_message.h"

#include <algorithm>
#include <cmath>

#include "freespace/shortest_text.h"

namespace vismap {
namespace {

constexpr int64_t kMostCells = 1 << 24;
constexpr double kMostOrdinate = 1e6;  // [m]

static_assert(static_cast<int>(CellState::kUnknown) == occupancy_grid_t::UNKNOWN);
static_assert(static_cast<int>(CellState::kFree) == occupancy_grid_t::FREE);
static_assert(static_cast<int>(CellState::kOccupied) == occupancy_grid_t::OCCUPIED);

Result<void> CheckCells(const occupancy_grid_t& message) {
  const int64_t cells = int64_t{message.width} * message.height;
  if (message.width < 0 || message.height < 0 || cells > kMostCells || cells != message.n_cells) {
    return Fail("it has " + std::to_string(message.n_cells) + " cells, expected width " +
                std::to_string(message.width) + " times height " + std::to_string(message.height) +
                " and at most 16777216");
  }
  for (const uint8_t state : message.states) {
    if (state > occupancy_grid_t::OCCUPIED)
      return Fail("states: expected 0, 1 or 2, found " + std::to_string(state));
  }
  for (const float distance : message.distances_m) {
    if (!(distance >= 0 && static_cast<double>(distance) <= kMostOrdinate))
      return Fail("distances_m: expected 0 to 1000000 m, found " +
                  ShortestText(static_cast<double>(distance)));
  }
  for (const float floor : message.floor_m) {
    if (std::isinf(floor))
      return Fail("floor_m: expected a height or NaN, found an infinite value");
  }
  return {};
}

Result<void> CheckGridHeader(const occupancy_grid_t& message) {
  if (!(message.resolution_m > 0 && message.resolution_m <= 1000))
    return Fail("resolution_m: expected more than 0 and at most 1000, found " +
                ShortestText(message.resolution_m));
  for (const double ordinate : message.origin_W) {
    if (!(std::abs(ordinate) <= kMostOrdinate))
      return Fail("origin_W: expected -1000000 to 1000000 m, found " + ShortestText(ordinate));
  }
  if (message.basis != occupancy_grid_t::BASIS_FLOOR &&
      message.basis != occupancy_grid_t::BASIS_BAND)
    return Fail("basis: expected 0 or 1, found " + std::to_string(message.basis));
  return {};
}

}  // namespace

occupancy_grid_t Encode(const GridMessage& value) {
  const GroundGrid& grid = value.grid;
  const GroundGridOptions& options = value.options;
  occupancy_grid_t message{};
  message.utime = value.utime;
  message.published_utime = value.published_utime;
  message.map_id = value.map_id;
  message.revision = value.revision;
  message.resolution_m = grid.resolution_m;
  message.origin_W[0] = grid.origin_W.x();
  message.origin_W[1] = grid.origin_W.y();
  message.width = grid.width;
  message.height = grid.height;
  message.basis = options.has_band() ? occupancy_grid_t::BASIS_BAND : occupancy_grid_t::BASIS_FLOOR;
  message.band_min_m = options.band_min_m;
  message.band_max_m = options.band_max_m;
  message.robot_height_m = options.robot_height_m;
  message.step_height_m = options.step_height_m;
  message.max_slope_deg = options.max_slope_deg;
  message.distance_limit_m = options.distance_limit_m;
  message.n_cells = static_cast<int32_t>(grid.states.size());
  for (const CellState state : grid.states) message.states.push_back(static_cast<uint8_t>(state));
  message.distances_m = grid.distances_m;
  message.floor_m = grid.floor_m;
  return message;
}

Result<GridMessage> Decode(const occupancy_grid_t& message) {
  const std::string where = "occupancy_grid_t of map '" + message.map_id + "', revision " +
                            std::to_string(message.revision) + ": ";
  for (const Result<void>& checked : {CheckGridHeader(message), CheckCells(message)}) {
    if (!checked) return Fail(where + checked.error().message);
  }
  GridMessage value{
      message.utime, message.published_utime, message.map_id, message.revision, {}, {}};
  value.options.resolution_m = message.resolution_m;
  value.options.band_min_m = message.band_min_m;
  value.options.band_max_m = message.band_max_m;
  value.options.robot_height_m = message.robot_height_m;
  value.options.step_height_m = message.step_height_m;
  value.options.max_slope_deg = message.max_slope_deg;
  value.options.distance_limit_m = message.distance_limit_m;
  value.grid.resolution_m = message.resolution_m;
  value.grid.origin_W = {message.origin_W[0], message.origin_W[1]};
  value.grid.width = message.width;
  value.grid.height = message.height;
  for (const uint8_t state : message.states)
    value.grid.states.push_back(static_cast<CellState>(state));
  value.grid.distances_m = message.distances_m;
  value.grid.floor_m = message.floor_m;
  return value;
}

}  // namespace vismap
