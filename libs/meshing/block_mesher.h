#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "meshing/cell_grid.h"
#include "meshing/crossed_edges.h"
#include "meshing/surface_cells.h"
#include "meshing/surface_vertex.h"

namespace vismap {

/// What all blocks of one meshing share; must outlive the meshers.
struct MeshingJob {
  const BlockViews& views;
  double voxel_size;                  ///< [m]
  double jump_fraction;               ///< see MeshingOptions
  std::span<const ShownLabel> shown;  ///< by label, see ShowSegments
};

/// Marching cubes over the 8x8x8 cells of blocks, one block after the other in ascending order. One
/// per thread.
class BlockMesher {
 public:
  explicit BlockMesher(const MeshingJob& job);

  /// Finds the cells and edges of a block that the surface crosses.
  void Find(BlockIndex block);
  BlockIndex block() const { return walk_.block(); }
  /// The mesh of the block that was found last. Each vertex has the ids that its label shows.
  Mesh MakeMesh();
  /// The lattice edge of each of its vertices, see EdgeSlot.
  std::span<const uint16_t> edge_slots() const { return edges_.slots(); }

 private:
  /// Whether the distance steps over the edge from at least jump_ to at most -jump_: there is no
  /// surface between, but space that the camera has not seen.
  bool IsJump(size_t slot) const;
  /// False when no crossed edge steps as far as a jump.
  bool MayCrossJumps() const;
  /// Removes the cells with a jump from the surface.
  void LeaveOutJumps();

  const MeshingJob& job_;
  int jump_;  // in steps of truncation / kTruncationSteps
  NeighbourWalk walk_;
  SurfaceReader reader_;
  CellGrid grid_;
  VertexMaker vertex_maker_;
  CellBits cells_;  // the cells to mesh; set when there are any
  CrossedEdges edges_;
  // Room for the largest mesh of a block, so that no step has to check for room.
  static constexpr size_t kMostTriangles = size_t{5} * kBlockVoxels;
  std::array<uint16_t, 3 * kMostTriangles + 1> corners_;  // slots
  std::array<std::array<uint32_t, 3>, kMostTriangles> triangles_;
};

}  // namespace vismap
