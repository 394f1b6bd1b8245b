#pragma once

#include <span>
#include <vector>

#include "meshing/cell_grid.h"
#include "meshing/crossed_edges.h"
#include "meshing/lattice_edge.h"
#include "meshing/shown_label.h"

namespace vismap {

/// Makes the vertices of a block, one per edge of its cells that the surface crosses. The position
/// is where the distance, linear between the two voxels, is zero, but at least 1 % off either, so
/// that no triangle collapses. The normal is the interpolated gradient, the colour is interpolated.
/// `seen` is that of the nearer voxel, or of the farther one where the nearer is in a free block.
/// The label is that of the nearer voxel if it has votes, else of the farther one, else the most
/// frequent label among the voxels that share a face with the two, else among those that share a
/// corner; ties go to the lower label. A vertex depends only on voxels around its edge, so that all
/// blocks with the edge make the same vertex.
class VertexMaker {
 public:
  /// `grid`: of the block whose vertices are made. `shown`: the ids that each label shows, by
  /// label.
  VertexMaker(const CellGrid& grid, double voxel_size, std::span<const ShownLabel> shown)
      : grid_(grid), voxel_size_(voxel_size), shown_(shown) {}

  /// Appends one vertex per listed edge, in their order.
  void Make(BlockIndex block, const CrossedEdges& edges, std::vector<MeshVertex>* vertices);

 private:
  /// Loads the distances around the edges `from` <= i < `to` of the list to the first lanes, which
  /// hold the ends of these edges.
  void LoadStars(const CrossedEdges& edges, size_t from, size_t to);
  /// Prefetches colours and votes at the ends of an edge.
  void PrefetchEnds(size_t lane) const;
  void LoadColors(size_t lane);
  MeshVertex VertexAt(size_t lane) const;
  ShownLabel LabelOf(size_t lane) const;
  uint8_t SeenOf(size_t lane) const;
  SegmentLabel LabelAt(const CellGrid::Place& place) const;
  /// The label of a voxel with votes, of which `entries` are the palette entries, one per byte. The
  /// label may be merged.
  SegmentLabel LabelOfVotes(const CellGrid::Place& place, uint32_t entries) const;
  SegmentLabel LabelAround(const LatticeEdge& edge) const;
  static constexpr size_t kMostAround = 3 * 3 * 4;
  /// The voxels around an edge that have votes: bit x + 4 y + 16 z, from one below its lower end
  /// on.
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
