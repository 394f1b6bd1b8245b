#pragma once

#include <span>
#include <vector>

#include "meshing/cell_grid.h"
#include "meshing/crossed_edges.h"
#include "meshing/lattice_edge.h"
#include "meshing/shown_label.h"

namespace vismap {

/// Makes the vertices of a block, where the surface crosses the edges of its cells: position linear
/// between the two voxels (kept 1 % off them, so that no triangle collapses), normal from the
/// interpolated gradient, colour interpolated, and the label of the nearest voxel that has votes:
/// of the two ends, else the most frequent one among the voxels that share a face with them, else
/// a corner (ties to the lower label). A vertex depends on the voxels around its edge only, so
/// every block that has the edge makes the same one.
class VertexMaker {
 public:
  /// `shown` = what labels show, see ShowLabels. The grid is that of the block at hand.
  VertexMaker(const CellGrid& grid, double voxel_size, std::span<const ShownLabel> shown)
      : grid_(grid), voxel_size_(voxel_size), shown_(shown) {}

  /// One vertex per listed edge, in their order.
  void Make(BlockIndex block, const CrossedEdges& edges, std::vector<MeshVertex>* vertices);

 private:
  /// The distances around the edges from <= i < to of a list, of which the first lanes have the
  /// ends.
  void LoadStars(const CrossedEdges& edges, size_t from, size_t to);
  /// Asks memory for the colours and votes at the ends of an edge.
  void PrefetchEnds(size_t lane) const;
  void LoadColors(size_t lane);
  MeshVertex VertexAt(size_t lane) const;
  ShownLabel LabelOf(size_t lane) const;
  SegmentLabel LabelAt(const CellGrid::Place& place) const;
  /// Of a voxel that has votes, for what its entries say; may be one that is not canonical.
  SegmentLabel LabelOfVotes(const CellGrid::Place& place, uint32_t entries) const;
  SegmentLabel LabelAround(const LatticeEdge& edge) const;
  static constexpr size_t kMostAround = 3 * 3 * 4;
  /// Which voxels around an edge have votes: bit x + 4 y + 16 z, from one below its lower end on.
  uint64_t VotedAround(const LatticeEdge& edge) const;
  SegmentLabel Canonical(SegmentLabel label) const {
    return Raw(label) < shown_.size() ? shown_[Raw(label)].segment : label;
  }

  const CellGrid& grid_;
  double voxel_size_;
  std::span<const ShownLabel> shown_;
  VertexLanes lanes_;
};

}  // namespace vismap
