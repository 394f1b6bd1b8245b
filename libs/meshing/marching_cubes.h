#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "map/block_rim.h"
#include "meshing/mesh.h"
#include "meshing/shown_label.h"

/// The room of surfaces: triangle meshes with ids out of the map (ALGORITHM 6.1), objects with
/// their boxes and meshes (6.2), and the files people take home. It reads the map and never changes
/// it. Pictures are drawn in render/.
namespace vismap {

struct MeshingOptions {
  /// Voxels up to this weight count as unseen; 1 = one frame at 1 m. The default asks for one frame
  /// within 2.6 m, or several from farther: a single far return is more noise than surface.
  /// (Published code: 1e-4.)
  double min_weight = 0.15;
  int min_observations = 1;  ///< voxels that fewer frames saw count as unseen
  /// Neighbouring voxels beyond this part of the truncation distance on either side are a jump
  /// between two surfaces, not a surface: their cells stay empty. Above 1 = keep them.
  double jump_fraction = 0.9;
  /// Connected pieces with fewer triangles are left out of the mesh of a whole map.
  int min_component_triangles = 20;
  /// Of the mesh of a whole map: islands below this share of the surface of their instance or
  /// segment show what they lie in, see AbsorbIslands; 0 = none do. (Published code: none.)
  double island_max_share = 0.1;
  double island_max_area = 0.01;  ///< larger ones do not [m^2]
  /// Of the mesh of a whole map: what is no farther from the plane of structure that it joins
  /// [voxel sizes] shows that, see AbsorbContacts; 0 = nothing does. (Published code: nothing.)
  double contact_voxels = 0.75;
};

/// Surface of one block: of the cells whose lowest corner voxel lies in it.
struct BlockMesh {
  BlockIndex block;
  Mesh mesh;  ///< no triangles = the block has no surface (any more): delete what was shown there
};

/// New surfaces of some blocks, ascending.
struct MeshDelta {
  int64_t revision = 0;  ///< of the map that they were made from
  std::vector<BlockMesh> blocks;
};

/// Zero level of the TSDF of the whole map (marching cubes over cells whose eight corners were all
/// observed; voxels of free blocks count as observed at + truncation), without small components.
/// Cells share vertices, also across blocks: where the map has no gaps and no rim, every edge
/// belongs to exactly two triangles. Order: ascending blocks. A vertex has the segment of the
/// nearest voxel with votes; its instance and class are not set (see objects/map_mesh.h).
Mesh ExtractSurface(const SemanticMap& map, const MeshingOptions& options = {});

/// Blocks whose surface may differ after some changes, ascending: those that changed, and of the
/// blocks that these affect the ones near a surface.
std::vector<BlockIndex> BlocksToMesh(const VoxelMap& map, const BlockChanges& changes);

/// The surface of some blocks, which ascend, block by block, for viewers that follow the map.
/// Blocks do not share vertices, small components stay, and the class of an instance weighs its
/// labels equally. `shown` = ShowLabels of the map's.
std::vector<BlockMesh> MeshEachBlock(const SemanticMap& map, std::span<const BlockIndex> blocks,
                                     std::span<const ShownLabel> shown,
                                     const MeshingOptions& options = {});

}  // namespace vismap
