#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/cell_grid.h"
#include "meshing/surface_cells.h"
#include "meshing/surface_vertex.h"

namespace vismap {

/// What the meshes of all blocks have in common; must outlive the mesher.
struct MeshingJob {
  const BlockViews& views;
  double voxel_size;                  ///< [m]
  double jump_fraction;               ///< as in MeshingOptions
  std::span<const ShownLabel> shown;  ///< what labels show
};

/// Marching cubes over the 8x8x8 cells of one block after the other, ascending. One per thread of
/// work.
class BlockMesher {
 public:
  explicit BlockMesher(const MeshingJob& job);

  /// The surface of a block; good until the next one. The edge of each vertex stands in edges().
  const std::vector<std::array<uint32_t, 3>>& Find(BlockIndex block);
  const std::vector<LatticeEdge>& edges() const { return edges_; }
  /// Makes the vertices of the surface that was found.
  void MakeVertices(std::vector<MeshVertex>* vertices);

 private:
  void MeshCell(int x, int y, int z);
  bool CrossesJump(size_t cube, const float* corner) const;
  uint32_t VertexOn(size_t edge, const LatticeEdge& cell, int cell_slot);

  const MeshingJob& job_;
  float jump_;  // in steps of truncation / 32767
  NeighbourWalk walk_;
  SurfaceReader reader_;
  CellGrid grid_;
  VertexMaker vertex_maker_;
  std::array<uint16_t, kEdgeSlots> vertex_of_slot_;  // kNoVertex between blocks
  std::vector<LatticeEdge> edges_;
  std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace vismap
