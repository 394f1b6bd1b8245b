#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

#include "mapping/integrate.h"
#include "meshing/marching_cubes.h"
#include "support/mesh_checks.h"

namespace vismap::testing_support {

/// The mesh of a map, updated after every frame in the blocks that BlocksToMesh names.
class FollowedMesh {
 public:
  explicit FollowedMesh(const MeshingOptions& options) : options_(options) {}

  /// Updates the mesh after a frame. Vertices show the labels as voted for, whether merged or not.
  void Follow(const SemanticMap& map, const MapDelta& delta) {
    const auto blocks = BlocksToMesh(map.voxels, delta.changes());
    for (BlockMesh& block : MeshEachBlock(map, blocks, {}, options_))
      meshes_[block.block] = std::move(block.mesh);
    meshed_ += blocks.size();
    whole_ += BlocksToMesh(map.voxels, delta.changed_blocks).size();
  }

  void ExpectUpToDate(const SemanticMap& map) {
    const auto all = BlocksToMesh(map.voxels, map.voxels.SortedIndices());
    for (const BlockMesh& block : MeshEachBlock(map, all, {}, options_)) {
      const Mesh& followed = meshes_[block.block];
      EXPECT_EQ(followed.triangles, block.mesh.triangles);
      EXPECT_TRUE(std::ranges::equal(followed.vertices, block.mesh.vertices, SameVertex));
      surfaces_ += !block.mesh.triangles.empty();
    }
  }

  /// Number of blocks with a surface that were compared.
  size_t surfaces() const { return surfaces_; }
  /// Number of blocks that were meshed, and that would have been if all voxels of each changed
  /// block had changed.
  size_t meshed() const { return meshed_; }
  size_t whole() const { return whole_; }

 private:
  MeshingOptions options_;
  std::map<BlockIndex, Mesh> meshes_;
  size_t surfaces_ = 0, meshed_ = 0, whole_ = 0;
};

}  // namespace vismap::testing_support
