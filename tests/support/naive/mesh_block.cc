#include "support/naive/mesh_block.h"

#include <octomap/octomap_types.h>
// Needs the types before it.
#include <octomap/MCTables.h>

#include <algorithm>
#include <cmath>

#include "map/surface_reader.h"
#include "support/naive/voxel_access.h"

namespace vismap::naive {
namespace {

// Corner order of the tables (Bourke), and which two corners each edge joins.
constexpr int kCorner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
constexpr int kEdgeEnds[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                  {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

/// The eight voxels of a cell and their distances.
struct Cell {
  VoxelIndex voxel[8];
  int distance[8];

  bool Behind(int corner) const { return distance[corner] < 0; }
  bool Crossed(int edge) const { return Behind(kEdgeEnds[edge][0]) != Behind(kEdgeEnds[edge][1]); }
};

std::optional<Cell> ReadCell(const VoxelMap& map, VoxelIndex low, const MeshingOptions& options) {
  Cell cell{};
  for (int i = 0; i < 8; ++i) {
    cell.voxel[i] = {low.x + kCorner[i][0], low.y + kCorner[i][1], low.z + kCorner[i][2]};
    const std::optional<int> distance = SeenDistance(map, cell.voxel[i], options);
    if (!distance) return std::nullopt;
    cell.distance[i] = *distance;
  }
  return cell;
}

/// Whether two surfaces meet in the cell, so that there is none between them.
bool HasJump(const Cell& cell, double jump_fraction) {
  const auto jump =
      static_cast<int>(std::lround(std::clamp(jump_fraction, 0.0, 2.0) * kTruncationSteps));
  for (int edge = 0; edge < 12; ++edge) {
    const int a = cell.distance[kEdgeEnds[edge][0]], b = cell.distance[kEdgeEnds[edge][1]];
    if (cell.Crossed(edge) && std::max(a, b) >= jump && std::min(a, b) <= -jump) return true;
  }
  return false;
}

/// Where the surface crosses an edge, counted from its lower voxel in the block's coordinates.
std::array<float, 3> Crossing(const Cell& cell, int edge, const VoxelMap& map) {
  int a = kEdgeEnds[edge][0], b = kEdgeEnds[edge][1];
  if (cell.voxel[b] < cell.voxel[a]) std::swap(a, b);
  const auto from = static_cast<float>(cell.distance[a]), to = static_cast<float>(cell.distance[b]);
  const double t = std::clamp(from / (from - to), 0.01F, 0.99F);
  const Eigen::Vector3d p(cell.voxel[a].x, cell.voxel[a].y, cell.voxel[a].z);
  const Eigen::Vector3d q(cell.voxel[b].x, cell.voxel[b].y, cell.voxel[b].z);
  const Eigen::Vector3d p_W = ((p.array() + 0.5).matrix() + (q - p) * t) * map.voxel_size();
  return {static_cast<float>(p_W.x()), static_cast<float>(p_W.y()), static_cast<float>(p_W.z())};
}

/// Lowest corner first, the turn kept.
Triangle Rotated(Triangle triangle) {
  std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  return triangle;
}

void MeshCell(const Cell& cell, const VoxelMap& map, std::vector<Triangle>* triangles) {
  size_t cube = 0;
  for (int i = 0; i < 8; ++i) cube |= static_cast<size_t>(cell.Behind(i)) << i;
  // The tables turn clockwise for corners that are set; ours are set behind the surface.
  for (const int* row = octomap::triTable[cube]; *row >= 0; row += 3) {
    triangles->push_back(Rotated(
        {Crossing(cell, row[0], map), Crossing(cell, row[2], map), Crossing(cell, row[1], map)}));
  }
}

}  // namespace

std::optional<int> SeenDistance(const VoxelMap& map, VoxelIndex voxel,
                                const MeshingOptions& options) {
  const Block* block = map.Find(BlockOf(voxel));
  if (block == nullptr) return std::nullopt;
  const int offset = OffsetInBlock(voxel);
  if (!block->surface) {
    // Free space remembers no more than two observations, so no more can be asked of it.
    const int wanted = std::clamp(options.min_observations, 1, 2);
    return TimesSeenFree(*block, offset) >= wanted ? std::optional(kTruncationSteps) : std::nullopt;
  }
  SurfaceReader reader;
  const StoredVoxel stored = ReadVoxel(*reader.Read(*block), offset);
  const int gate = static_cast<int>(options.min_weight * static_cast<double>(kWeightScale));
  if (stored.weight <= gate || stored.observations < options.min_observations) return std::nullopt;
  return stored.distance;
}

std::vector<Triangle> MeshBlock(const SemanticMap& map, BlockIndex block,
                                const MeshingOptions& options) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < kBlockVoxels; ++i) {
    const VoxelIndex low{block.x * kBlockSide + i % kBlockSide,
                         block.y * kBlockSide + i / kBlockSide % kBlockSide,
                         block.z * kBlockSide + i / (kBlockSide * kBlockSide)};
    const std::optional<Cell> cell = ReadCell(map.voxels, low, options);
    if (cell && !HasJump(*cell, options.jump_fraction)) MeshCell(*cell, map.voxels, &triangles);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<Triangle> SortedTriangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  const auto corner = [&](uint32_t vertex) {
    const Eigen::Vector3f& p = mesh.vertices[vertex].position_W;
    return std::array<float, 3>{p.x(), p.y(), p.z()};
  };
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.push_back(Rotated({corner(a), corner(b), corner(c)}));
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace vismap::naive
