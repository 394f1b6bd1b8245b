#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "meshing/marching_cubes.h"

namespace vismap {

/// The surface of a growing map, counted per label: for every block, how much surface each label
/// has in the block's last mesh, and a sample of its vertices. An update costs little time and
/// memory compared to the meshing itself.
class BlockSurfaces {
 public:
  /// The surface of one label in all blocks together.
  struct Amount {
    /// A vertex on the face between two blocks is in the meshes of both and counts once, in the
    /// block with the larger coordinates. It is missing where that block has no mesh, at the border
    /// of the observed space.
    int64_t vertices = 0;
    double area = 0;       ///< [m^2]
    uint32_t version = 0;  ///< changes whenever a block adds or removes surface of this label
  };

  void Clear();
  /// Replaces the surface of a block by that of its new mesh (from MeshBlocks). A mesh without
  /// triangles removes the block. `voxel_size` [m]. Returns whether the block has a surface now or
  /// had one before.
  bool Update(const BlockMesh& block, double voxel_size);
  bool Has(const BlockIndex& block) const { return blocks_.contains(block); }
  /// The blocks that have a surface, in no particular order.
  std::vector<BlockIndex> Blocks() const;

  /// Memory [bytes], about; takes constant time.
  size_t bytes() const;

  /// Zero for labels that never had a surface.
  Amount AmountOf(SegmentLabel label) const;
  /// Appends an even sample of half the vertices of a label in one block [m], rounded to 1/32 of a
  /// voxel. Appends nothing when the block has no surface of the label. `voxel_size` [m].
  void AddPoints(SegmentLabel label, const BlockIndex& block, double voxel_size,
                 std::vector<Eigen::Vector3f>* points_W) const;

 private:
  // Offset from the centre of the block's first voxel, in 1/32 of a voxel.
  using Point = std::array<uint8_t, 3>;
  // The surface of one label in one block.
  struct Piece {
    SegmentLabel label = SegmentLabel::kNone;
    uint32_t vertices = 0;
    double area = 0;  // [m^2]
    std::vector<Point> points;
  };

  static std::vector<Piece> PiecesOf(const BlockMesh& block, double voxel_size);
  void Count(const Piece& piece, int sign);
  static size_t BytesOf(const std::vector<Piece>& pieces);

  tsl::robin_map<BlockIndex, std::vector<Piece>, BlockIndexHash> blocks_;
  std::vector<Amount> amounts_;  // by label
  size_t piece_bytes_ = 0;       // of all blocks
};

}  // namespace vismap
