#include "pictures/octree_picture.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "base/format.h"
#include "render/palette.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kRim = 0.08;            // width of the dark edge of a face, as a share of the face
constexpr double kRimShade = 0.55;       // its brightness
constexpr size_t kMostRimmed = 200'000;  // more faces are drawn without edges

/// A side of an occupied leaf.
struct Face {
  VoxelIndex cell;
  int axis = 0;
  int sign = 1;
};

constexpr std::array<std::pair<int, int>, 6> kSides{
    {{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}}};

VoxelIndex Neighbour(VoxelIndex cell, int axis, int sign) {
  (axis == 0 ? cell.x : axis == 1 ? cell.y : cell.z) += sign;
  return cell;
}

class FaceFinder {
 public:
  FaceFinder(const OccupancyMap& cells, const OctreePictureOptions& options, bool any_free)
      : cells_(cells), options_(options), any_free_(any_free) {}

  Result<std::vector<Face>> Find() {
    for (const BlockIndex& index : cells_.SortedIndices()) {
      const BlockOccupancy& block = cells_.At(index);
      if (block.is(CellState::kFree)) continue;
      for (int i = 0; i < kBlockVoxels; ++i)
        if (block.At(i) == CellState::kOccupied) AddCell(VoxelAt(index, i));
      if (std::ssize(faces_) > kMostCubeFaces) {
        return Fail("the octree has more than " + std::to_string(kMostCubeFaces) +
                    " faces between occupied and free leaves; draw a part of it, or larger leaves");
      }
    }
    return std::move(faces_);
  }

 private:
  bool IsShown(VoxelIndex cell) const {
    if (!options_.below_m) return true;
    const Vector3d center_W =
        Vector3d(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) * cells_.cell_size();
    return center_W.dot(options_.up_W) < *options_.below_m;
  }

  bool IsOpen(VoxelIndex cell, int axis, int sign) const {
    const VoxelIndex next = Neighbour(cell, axis, sign);
    const CellState state = cells_.At(next);
    if (state == CellState::kOccupied) return !IsShown(next);
    return state == CellState::kFree || !any_free_ ||
           cells_.At(Neighbour(next, axis, sign)) == CellState::kFree;
  }

  void AddCell(VoxelIndex cell) {
    if (!IsShown(cell)) return;
    for (const auto& [axis, sign] : kSides)
      if (IsOpen(cell, axis, sign)) faces_.push_back({cell, axis, sign});
  }

  const OccupancyMap& cells_;
  const OctreePictureOptions& options_;
  bool any_free_;
  std::vector<Face> faces_;
};

class CubeMesher {
 public:
  CubeMesher(double leaf_m, bool rims, Mesh* mesh) : leaf_m_(leaf_m), rims_(rims), mesh_(mesh) {}

  void Add(const Face& face, Rgb8 color) {
    const auto axis = face.axis;
    normal_ = face.sign * Vector3f::Unit(axis);
    // Counter-clockwise as seen from outside.
    u_ = Vector3f::Unit((axis + 1) % 3);
    v_ = Vector3f::Unit((axis + 2) % 3);
    if (face.sign < 0) std::swap(u_, v_);
    const Vector3d middle(face.cell.x + 0.5, face.cell.y + 0.5, face.cell.z + 0.5);
    center_ = ((middle + 0.5 * normal_.cast<double>()) * leaf_m_).cast<float>();
    const double inner = rims_ ? 0.5 - kRim : 0.5;
    const uint32_t quad = AddCorners(inner, color);
    mesh_->triangles.push_back({quad, quad + 1, quad + 2});
    mesh_->triangles.push_back({quad, quad + 2, quad + 3});
    if (rims_) AddRim(inner, color);
  }

 private:
  uint32_t AddCorners(double half, Rgb8 color) {
    const auto first = static_cast<uint32_t>(mesh_->vertices.size());
    constexpr std::array<std::pair<int, int>, 4> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    const auto reach = static_cast<float>(half * leaf_m_);
    for (const auto& [a, b] : kCorners) {
      MeshVertex vertex;
      vertex.position_W =
          center_ + reach * (static_cast<float>(a) * u_ + static_cast<float>(b) * v_);
      vertex.normal_W = normal_;
      vertex.color = color;
      mesh_->vertices.push_back(vertex);
    }
    return first;
  }

  void AddRim(double inner, Rgb8 color) {
    const auto darker = [](uint8_t value) { return static_cast<uint8_t>(value * kRimShade); };
    const Rgb8 dark{darker(color.r), darker(color.g), darker(color.b)};
    const uint32_t inside = AddCorners(inner, dark), outside = AddCorners(0.5, dark);
    for (uint32_t i = 0; i < 4; ++i) {
      const uint32_t next = (i + 1) % 4;
      mesh_->triangles.push_back({outside + i, outside + next, inside + next});
      mesh_->triangles.push_back({outside + i, inside + next, inside + i});
    }
  }

  double leaf_m_;
  bool rims_;
  Mesh* mesh_;
  Vector3f center_ = Vector3f::Zero(), normal_ = Vector3f::Zero();
  Vector3f u_ = Vector3f::Zero(), v_ = Vector3f::Zero();
};

double HeightOf(const Face& face, const Vector3d& up_W, double leaf_m) {
  return Vector3d(face.cell.x + 0.5, face.cell.y + 0.5, face.cell.z + 0.5).dot(up_W) * leaf_m;
}

std::pair<double, double> HeightsOf(const std::vector<Face>& faces, const Vector3d& up_W,
                                    double leaf_m) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Face& face : faces) {
    low = std::min(low, HeightOf(face, up_W, leaf_m));
    high = std::max(high, HeightOf(face, up_W, leaf_m));
  }
  if (faces.empty()) return {0, leaf_m};
  return {low, std::max(high, low + leaf_m)};
}

Rgb8 FileColor(const OctreeLeaves& leaves, VoxelIndex cell) {
  const auto found = leaves.colors->find(BlockOf(cell));
  if (found == leaves.colors->end()) return kUnsegmentedColor;
  return found->second[static_cast<size_t>(OffsetInBlock(cell))];
}

}  // namespace

Result<LeafCubes> MakeLeafCubes(const OctreeLeaves& leaves, const OctreePictureOptions& options) {
  LeafCubes cubes;
  cubes.leaf_m = leaves.cells.cell_size();
  const CellCounts counts = CountCells(leaves.cells);
  cubes.free = counts.free;
  cubes.occupied = counts.occupied;
  const auto faces = FaceFinder(leaves.cells, options, cubes.free > 0).Find();
  if (!faces) return tl::unexpected(faces.error());
  const bool file_colors = options.file_colors && leaves.colors;
  const auto [low, high] = HeightsOf(*faces, options.up_W, cubes.leaf_m);
  if (!file_colors) cubes.scale = ColorScale{"height in W", MetresText(low), MetresText(high)};
  CubeMesher mesher(cubes.leaf_m, faces->size() <= kMostRimmed, &cubes.mesh);
  for (const Face& face : *faces) {
    const double share = (HeightOf(face, options.up_W, cubes.leaf_m) - low) / (high - low);
    mesher.Add(face, file_colors ? FileColor(leaves, face.cell) : RampColor(share));
  }
  return cubes;
}

Caption CubesCaption(const LeafCubes& cubes, const std::string& title) {
  Caption caption;
  caption.title = title;
  caption.scale = cubes.scale;
  caption.legend = {{{}, "leaves of " + MetresText(cubes.leaf_m)},
                    {{}, FormatCount(cubes.occupied, "occupied leaf", "occupied leaves")},
                    {{}, FormatCount(cubes.free, "free leaf", "free leaves") + ", not drawn"}};
  return caption;
}

}  // namespace vismap
