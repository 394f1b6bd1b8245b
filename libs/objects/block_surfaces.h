#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "meshing/marching_cubes.h"

namespace vismap {

/// How much surface of each label the last mesh of every block had, and where: of a growing map,
/// kept up to date block by block with work and memory that are small beside those of the meshes.
class BlockSurfaces {
 public:
  /// The surface of one label.
  struct Amount {
    /// Each once, though blocks share them; some at the rim of what was seen are left out.
    int64_t vertices = 0;
    double area = 0;       ///< [m^2]
    uint32_t version = 0;  ///< another one whenever a block's surface of it was made anew
  };

  void Clear();
  /// Takes over a new mesh of a block, as MeshBlocks makes them; one without triangles forgets the
  /// block. `voxel_size` [m]. Returns whether the block has a surface, or had one.
  bool Update(const BlockMesh& block, double voxel_size);
  bool Has(const BlockIndex& block) const { return blocks_.contains(block); }
  /// Blocks that have a surface, in no order that means anything.
  std::vector<BlockIndex> Blocks() const;

  /// Nothing of labels that were never met.
  Amount Of(SegmentLabel label) const;
  /// Appends an even pick of half the vertices of a label in a block, to 1/32 of a voxel.
  void AddPoints(SegmentLabel label, const BlockIndex& block, double voxel_size,
                 std::vector<Eigen::Vector3f>* points_W) const;

 private:
  using Point = std::array<uint8_t, 3>;  // from the block's first voxel centre, in 1/32 of a voxel
  struct Piece {
    SegmentLabel label = SegmentLabel::kNone;
    uint32_t vertices = 0;
    double area = 0;  // [m^2]
    std::vector<Point> points;
  };

  static std::vector<Piece> PiecesOf(const BlockMesh& block, double voxel_size);
  void Count(const Piece& piece, int sign);

  tsl::robin_map<BlockIndex, std::vector<Piece>, BlockIndexHash> blocks_;
  std::vector<Amount> amounts_;  // by label
};

}  // namespace vismap
