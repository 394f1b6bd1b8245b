#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "map/block_rim.h"
#include "meshing/mesh.h"
#include "meshing/shown_label.h"

// This room makes triangle meshes of a map and never changes it. The method is described in
// libs/METHOD.md, Meshing.

namespace vismap {

struct MeshingOptions {
  /// Voxels count as observed above this weight; 1 = one frame from 1 m. With the default, one
  /// frame is enough within 2.6 m: a single return from farther away is more noise than surface.
  /// (Published code: 1e-4.)
  double min_weight = 0.15;
  int min_observations = 1;  ///< and if at least this many frames saw them
  /// Cells stay empty if the distance changes along an edge from at least this share of the
  /// truncation distance to at most minus this share: between two surfaces lies unseen space. Above
  /// 1 = such cells are meshed.
  double jump_fraction = 0.9;

  // These are for the mesh of a whole map only.
  /// Connected pieces with fewer triangles are left out.
  int min_component_triangles = 20;
  /// A piece with less than this share of the surface of its instance or segment shows the ids of
  /// the surface around it, see AbsorbIslands; 0 = never. (Published code: never.)
  double island_max_share = 0.1;
  double island_max_area_m2 = 0.01;  ///< the largest piece that does [m^2]
  /// Surface within this distance [voxels] of a plane of structure that it touches shows the ids of
  /// the structure, see AbsorbContacts; 0 = never. (Published code: never.)
  double contact_voxels = 0.75;
};

/// The mesh of one block: of the cells whose lowest corner voxel lies in it.
struct BlockMesh {
  BlockIndex block;
  Mesh
      mesh;  ///< without triangles, the block has no surface: an earlier mesh of it must be deleted
};

/// New surfaces of some blocks, ascending.
struct MeshDelta {
  int64_t revision = 0;  ///< of the map that they were made from
  std::vector<BlockMesh> blocks;
};

/// The zero level of the TSDF of the whole map, without small components: marching cubes over the
/// cells whose eight corners were all observed. Voxels of free blocks count as observed at
/// + truncation. Cells share vertices, also across blocks, so that every edge belongs to exactly
/// two triangles where the map has no gap and no rim. Blocks ascend. A vertex has the segment of
/// the nearest voxel with votes; instance and class are not set (see objects/map_mesh.h).
Mesh ExtractSurface(const SemanticMap& map, const MeshingOptions& options = {});

/// The blocks whose mesh may differ after some changes, ascending: the changed blocks, and those of
/// the affected blocks that are near a surface.
std::vector<BlockIndex> BlocksToMesh(const VoxelMap& map, const BlockChanges& changes);

/// The meshes of some blocks, ascending, for viewers that follow the map. Blocks do not share
/// vertices, and small components stay. `shown`: the ids that each label shows, by label.
std::vector<BlockMesh> MeshEachBlock(const SemanticMap& map, std::span<const BlockIndex> blocks,
                                     std::span<const ShownLabel> shown,
                                     const MeshingOptions& options = {});

}  // namespace vismap
