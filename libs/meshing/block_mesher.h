#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "meshing/cell_grid.h"
#include "meshing/crossed_edges.h"
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
  BlockIndex block() const { return walk_.block(); }
  /// The surface that was found. The vertices have what their labels show.
  Mesh MakeMesh();
  /// Where its vertices are, as numbers of EdgeSlot.
  std::span<const uint16_t> edge_slots() const { return edges_.slots(); }

 private:
  /// A step from well before the surface to well behind it: no surface, but something hidden.
  bool IsJump(size_t slot) const;
  bool MayCrossJumps() const;  // a jump goes that far, but not all that do are one
  void LeaveOutJumps();

  const MeshingJob& job_;
  int jump_;  // in steps of truncation / 32767
  NeighbourWalk walk_;
  SurfaceReader reader_;
  CellGrid grid_;
  VertexMaker vertex_maker_;
  CellBits cells_;  // meshed ones, where there are edges
  CrossedEdges edges_;
  // With room for everything, so that nothing is asked on the way.
  static constexpr size_t kMostTriangles = size_t{5} * kBlockVoxels;
  std::array<uint16_t, 3 * kMostTriangles + 1> corners_;  // slots
  std::array<std::array<uint32_t, 3>, kMostTriangles> triangles_;
};

}  // namespace vismap
