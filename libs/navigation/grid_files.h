#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/result.h"
#include "navigation/ground_grid.h"

namespace vismap {

/// The files of a grid as map_server (ROS) and nav2 read them.
struct GridFiles {
  std::filesystem::path image;  ///< PREFIX.pgm
  std::filesystem::path yaml;   ///< PREFIX.yaml, which names the image beside it
};

/// The image of a grid, binary PGM (P5): free 254, unknown 205, occupied 0; its first row is the
/// one of the largest y.
std::vector<uint8_t> GridPgm(const GroundGrid& grid);

/// The description that belongs to the image: mode trinary, origin = the grid's corner, and
/// free_thresh 0.196, with which 205 is unknown (with 0.25 nav2 would take it for free).
std::string GridYaml(const GroundGrid& grid, const std::string& image_name);

/// Writes both files, atomically; the folder must exist. `where` is a folder, which gets map.pgm
/// and map.yaml, or the path of the files without their endings. Fails when the grid is empty or a
/// file cannot be written.
Result<GridFiles> WriteGridFiles(const GroundGrid& grid, const std::filesystem::path& where);

}  // namespace vismap
