#include "meshing/marching_cubes.h"

#include "base/parallel.h"
#include "meshing/block_mesher.h"
#include "meshing/block_set.h"
#include "meshing/mesh_parts.h"
#include "meshing/stitcher.h"

namespace vismap {
namespace {

// The meshes of ascending blocks: `make(mesher)` returns that of the block that the mesher has
// found.
template <typename Local, typename Make>
std::vector<Local> MeshEach(const std::vector<BlockIndex>& blocks, const MeshingJob& job,
                            const Make& make) {
  constexpr size_t kGroup = 64;  // blocks per mesher, which unpacks shared neighbours once
  std::vector<Local> meshes(blocks.size());
  ParallelForGroups(blocks.size(), kGroup, [&](size_t from, size_t to) {
    BlockMesher mesher(job);
    for (size_t i = from; i < to; ++i) {
      mesher.Find(blocks[i]);
      meshes[i] = make(&mesher);
    }
  });
  return meshes;
}

std::vector<BlockIndex> BlocksWithSurface(const VoxelMap& map) {
  std::vector<BlockIndex> blocks;
  map.blocks().ForEach([&](BlockIndex index, const Block& block) {
    if (block.surface) blocks.push_back(index);
  });
  return blocks;
}

// Blocks that may have surface cells: those of `blocks` with surface voxels and, since a cell
// reaches one voxel up, their lower neighbours.
BlockSet CandidateBlocks(const VoxelMap& map, const std::vector<BlockIndex>& blocks) {
  const BlockViews own(map, blocks);
  const BlockViews reached(map, BlockSet(own.WithSurface()).Grown(1, 0).Blocks());
  std::vector<BlockIndex> candidates;
  for (const BlockView& view : reached.views()) {
    if (view.block != nullptr) candidates.push_back(view.index);
  }
  return BlockSet(candidates);
}

// The changed blocks, and of the affected ones those with surface voxels in them or in an upper
// neighbour, since a cell reaches one voxel up.
BlockSet ToMesh(const BlockSet& changed, const BlockSet& affected, const BlockViews& views) {
  const BlockSet by_surface = BlockSet(views.WithSurface()).Grown(1, 0);
  return changed.Union(affected.Intersection(by_surface));
}

// The meshes of all blocks of a set, also of those without surface.
std::vector<BlockMesh> MeshSet(const BlockSet& set, const MeshingJob& job) {
  return MeshEach<BlockMesh>(set.Blocks(), job, [](BlockMesher* mesher) {
    return BlockMesh{mesher->block(), mesher->MakeMesh()};
  });
}

}  // namespace

Mesh ExtractSurface(const SemanticMap& map, const MeshingOptions& options) {
  const BlockSet candidates = CandidateBlocks(map.voxels, BlocksWithSurface(map.voxels));
  BlockViews views(map.voxels, candidates.Grown(1, 1).Blocks());
  views.ReadVoxels(options);
  const std::vector<BlockIndex> blocks = candidates.Blocks();
  const std::vector<ShownLabel> shown = ShowSegments(map.labels);
  const auto parts =
      MeshEach<LocalMesh>(blocks, {views, map.voxels.voxel_size(), options.jump_fraction, shown},
                          [](BlockMesher* mesher) {
                            const auto slots = mesher->edge_slots();
                            return LocalMesh{mesher->MakeMesh(), {slots.begin(), slots.end()}};
                          });
  Stitcher stitcher;
  for (size_t i = 0; i < blocks.size(); ++i) stitcher.Add(blocks[i], parts[i]);
  return RemoveSmallComponents(stitcher.Finish(), options.min_component_triangles);
}

std::vector<BlockIndex> BlocksToMesh(const VoxelMap& map, const BlockChanges& changes) {
  const BlockSet changed(changes.blocks), affected = BlockSet::AffectedBy(changes);
  return ToMesh(changed, affected, BlockViews(map, affected.Grown(0, 1).Blocks())).Blocks();
}

std::vector<BlockMesh> MeshEachBlock(const SemanticMap& map, std::span<const BlockIndex> blocks,
                                     std::span<const ShownLabel> shown,
                                     const MeshingOptions& options) {
  const BlockSet meshed(blocks);
  BlockViews views(map.voxels, meshed.Grown(1, 1).Blocks());
  views.ReadVoxels(options);
  return MeshSet(meshed, {views, map.voxels.voxel_size(), options.jump_fraction, shown});
}

}  // namespace vismap
