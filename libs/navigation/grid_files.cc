#include "navigation/grid_files.h"

#include <cmath>

#include "base/file.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

uint8_t GreyOf(CellState state) {
  if (state == CellState::kFree) return 254;
  return state == CellState::kOccupied ? 0 : 205;
}

/// A number with six digits after the point: a micrometre is enough, and no rounding shows.
std::string MetersText(double value) { return ShortestText(std::round(value * 1e6) / 1e6 + 0.0); }

GridFiles NamesFor(const std::filesystem::path& where) {
  const bool folder = std::filesystem::is_directory(where) || where.filename().empty();
  const std::string prefix = (folder ? where / "map" : where).string();
  return {prefix + ".pgm", prefix + ".yaml"};
}

}  // namespace

std::vector<uint8_t> GridPgm(const GroundGrid& grid) {
  const std::string header =
      "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + grid.states.size());
  for (int y = grid.height - 1; y >= 0; --y) {
    for (int x = 0; x < grid.width; ++x) bytes.push_back(GreyOf(grid.states[grid.Index(x, y)]));
  }
  return bytes;
}

std::string GridYaml(const GroundGrid& grid, const std::string& image_name) {
  return "image: " + image_name + "\nmode: trinary\nresolution: " + MetersText(grid.resolution_m) +
         "\norigin: [" + MetersText(grid.origin_W.x()) + ", " + MetersText(grid.origin_W.y()) +
         ", 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

Result<GridFiles> WriteGridFiles(const GroundGrid& grid, const std::filesystem::path& where) {
  if (grid.states.empty()) return Fail("ground grid: nothing is known of free space in the map");
  GridFiles files = NamesFor(where);
  if (const auto done = WriteFileAtomically(files.image, GridPgm(grid)); !done)
    return tl::unexpected(done.error());
  const std::string yaml = GridYaml(grid, files.image.filename().string());
  if (const auto done = WriteFileAtomically(files.yaml, yaml); !done)
    return tl::unexpected(done.error());
  return files;
}

}  // namespace vismap
