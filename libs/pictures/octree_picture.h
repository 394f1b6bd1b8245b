#pragma once

#include <cstdint>
#include <optional>

#include "base/result.h"
#include "meshing/mesh.h"
#include "pictures/octree_file.h"
#include "render/drawing.h"

namespace vismap {

struct OctreePictureOptions {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();  ///< unit length
  std::optional<double>
      below_m{};             ///< leaves are shown whose centre is below this height along up_W
  bool file_colors = false;  ///< those of the tree, if it has any, instead of heights
};

/// The occupied leaves of an octree as cubes with darker edges, to be drawn with Coloring::kRgb.
struct LeafCubes {
  Mesh mesh;
  std::optional<ColorScale> scale;  ///< of the heights
  int64_t free = 0, occupied = 0;   ///< leaves of the smallest size
  double leaf_m = 0;                ///< their edge [m]
};

/// With more faces than this, no picture is made.
inline constexpr int64_t kMostCubeFaces = 2'000'000;

/// Makes the cubes. A face is made when the leaf before it, or the one behind that, is free, and
/// where the cut at `below_m` is. Other faces toward unknown space are not, so that a closed room
/// is seen through its near walls, as in pictures of its surface. In a tree without free leaves,
/// all faces toward leaves that are not occupied are made. Fails when there are more than
/// kMostCubeFaces.
Result<LeafCubes> MakeLeafCubes(const OctreeLeaves& leaves, const OctreePictureOptions& options);

/// The legend of such a picture.
Caption CubesCaption(const LeafCubes& cubes, const std::string& title);

}  // namespace vismap
