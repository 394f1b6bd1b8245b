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

  /// Finds the surface of a block.
  void Find(BlockIndex block);
  /// The surface that was found. The vertices have what their labels show.
  Mesh MakeMesh();
  /// Where its vertices are, as numbers of EdgeSlot.
  std::span<const uint16_t> edge_slots() const { return std::span(slots_).first(vertices_); }

 private:
  void MeshCell(int x, int y, int z);
  void AddCell(size_t cube, size_t cell_slot);
  bool CrossesJump(size_t cube, const float* corner) const;
  uint32_t VertexOn(size_t slot);

  const MeshingJob& job_;
  float jump_;  // in steps of truncation / 32767
  NeighbourWalk walk_;
  SurfaceReader reader_;
  CellGrid grid_;
  VertexMaker vertex_maker_;
  std::array<uint16_t, kEdgeSlots> vertex_of_slot_;  // kNoVertex between blocks
  // Arrays with room for everything, so that nothing is asked on the way.
  std::array<uint16_t, kEdgeSlots + 1> slots_;  // of the vertices
  size_t vertices_ = 0;
  std::array<std::array<uint32_t, 3>, 5 * kBlockVoxels + 3> triangles_;
  size_t triangle_count_ = 0;
};

}  // namespace vismap
