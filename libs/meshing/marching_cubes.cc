#include "meshing/marching_cubes.h"

#include <octomap/octomap_types.h>
// Needs the types before it.
#include <octomap/MCTables.h>
#include <tsl/robin_map.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "meshing/cell_grid.h"
#include "meshing/mesh_parts.h"
#include "meshing/read_out.h"
#include "meshing/surface_vertex.h"

namespace vismap {
namespace {

// Corner order of the tables (Bourke): around the lower face, then around the upper one.
constexpr std::array<std::array<int, 3>, 8> kCorner = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
constexpr std::array<std::array<int, 2>, 12> kEdgeEnds = {{{0, 1},
                                                           {1, 2},
                                                           {2, 3},
                                                           {3, 0},
                                                           {4, 5},
                                                           {5, 6},
                                                           {6, 7},
                                                           {7, 4},
                                                           {0, 4},
                                                           {1, 5},
                                                           {2, 6},
                                                           {3, 7}}};

// An edge of a cell as a lattice edge relative to the cell's lowest corner.
constexpr LatticeEdge CellEdge(size_t edge) {
  const auto& a = kCorner[static_cast<size_t>(kEdgeEnds[edge][0])];
  const auto& b = kCorner[static_cast<size_t>(kEdgeEnds[edge][1])];
  return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]),
          a[0] != b[0] ? 0 : (a[1] != b[1] ? 1 : 2)};
}

constexpr int kEdgeSlots = CellGrid::kCorners * CellGrid::kCorners * CellGrid::kCorners * 3;

constexpr int EdgeSlot(const LatticeEdge& e) {
  return e.axis + 3 * (e.x + CellGrid::kCorners * (e.y + CellGrid::kCorners * e.z));
}

// The mesh of one block before it is joined with others: edge_slots[i] = lattice edge of vertex i.
struct LocalMesh {
  Mesh mesh;
  std::vector<uint16_t> edge_slots;
};

// Marching cubes over the 8x8x8 cells of a block.
class BlockMesher {
 public:
  BlockMesher(const SemanticMap& map, BlockIndex block, const MeshingOptions& options,
              SurfaceReader* reader)
      : grid_(map.voxels, block, options, reader), map_(map) {
    if (!grid_.HasSurface()) return;
    jump_ = static_cast<int>(std::lround(std::clamp(options.jump_fraction, 0.0, 2.0) * 32767));
    vertex_of_slot_.fill(-1);
    for (int z = 0; z < kBlockSide; ++z) {
      for (int y = 0; y < kBlockSide; ++y) MeshRow(y, z);
    }
  }
  LocalMesh Take() { return std::move(result_); }

 private:
  // One row of cells at a time, on bits: most rows have no surface and end here.
  void MeshRow(int y, int z) {
    uint32_t all = ~0u, any_behind = 0, all_behind = ~0u;
    for (int dz = 0; dz < 2; ++dz) {
      for (int dy = 0; dy < 2; ++dy) {
        const uint32_t observed = grid_.ObservedRow(y + dy, z + dz);
        const uint32_t behind = grid_.BehindRow(y + dy, z + dz);
        all &= observed & (observed >> 1);
        any_behind |= behind | (behind >> 1);
        all_behind &= behind & (behind >> 1);
      }
    }
    uint32_t cells = all & any_behind & ~all_behind & 0xFFu;
    for (; cells != 0; cells &= cells - 1) MeshCell(std::countr_zero(cells), y, z);
  }

  void MeshCell(int x, int y, int z) {
    size_t cube = 0;
    for (size_t i = 0; i < 8; ++i) {
      const int d = grid_.Distance(x + kCorner[i][0], y + kCorner[i][1], z + kCorner[i][2]);
      if (d < 0) cube |= size_t{1} << i;
    }
    if (CrossesJump(cube, x, y, z)) return;
    const int* row = octomap::triTable[cube];
    // The tables turn clockwise for corners that are set; ours are set behind the surface.
    for (int i = 0; row[i] >= 0; i += 3) {
      result_.mesh.triangles.push_back({VertexOn(row[i], x, y, z), VertexOn(row[i + 2], x, y, z),
                                        VertexOn(row[i + 1], x, y, z)});
    }
  }

  bool CrossesJump(size_t cube, int x, int y, int z) const {
    const auto distance = [&](int i) {
      const auto& c = kCorner[static_cast<size_t>(i)];
      return static_cast<int>(grid_.Distance(x + c[0], y + c[1], z + c[2]));
    };
    for (const auto& [a, b] : kEdgeEnds) {
      if (((cube >> a) & 1) == ((cube >> b) & 1)) continue;
      const int da = distance(a), db = distance(b);
      if (std::max(da, db) >= jump_ && std::min(da, db) <= -jump_) return true;
    }
    return false;
  }

  uint32_t VertexOn(int edge, int x, int y, int z) {
    LatticeEdge lattice = CellEdge(static_cast<size_t>(edge));
    lattice.x += x;
    lattice.y += y;
    lattice.z += z;
    const auto slot = static_cast<size_t>(EdgeSlot(lattice));
    if (vertex_of_slot_[slot] < 0) {
      vertex_of_slot_[slot] = static_cast<int32_t>(result_.mesh.vertices.size());
      result_.mesh.vertices.push_back(
          MakeSurfaceVertex(grid_, lattice, map_.voxels.voxel_size(), map_.labels));
      result_.edge_slots.push_back(static_cast<uint16_t>(slot));
    }
    return static_cast<uint32_t>(vertex_of_slot_[slot]);
  }

  CellGrid grid_;
  const SemanticMap& map_;
  int jump_ = 0;
  std::array<int32_t, kEdgeSlots> vertex_of_slot_;
  LocalMesh result_;
};

void SortUnique(std::vector<BlockIndex>* blocks) {
  std::sort(blocks->begin(), blocks->end());
  blocks->erase(std::unique(blocks->begin(), blocks->end()), blocks->end());
}

// Blocks that may have surface cells, ascending: those of `blocks` with surface voxels and, since a
// cell reaches one voxel up, their lower neighbours.
std::vector<BlockIndex> CandidateBlocks(const VoxelMap& map,
                                        const std::vector<BlockIndex>& blocks) {
  std::vector<BlockIndex> candidates;
  for (const BlockIndex& index : blocks) {
    const Block* block = map.Find(index);
    if (block == nullptr || !block->surface) continue;
    for (int i = 0; i < 8; ++i) {
      const BlockIndex below{index.x - (i & 1), index.y - (i >> 1 & 1), index.z - (i >> 2)};
      if (i == 0 || map.Find(below) != nullptr) candidates.push_back(below);
    }
  }
  SortUnique(&candidates);
  return candidates;
}

std::vector<BlockIndex> BlocksWithSurface(const VoxelMap& map) {
  std::vector<BlockIndex> blocks;
  for (const auto& [index, block] : map.table()) {
    if (block.surface) blocks.push_back(index);
  }
  return blocks;
}

std::vector<LocalMesh> MeshEach(const SemanticMap& map, const std::vector<BlockIndex>& blocks,
                                const MeshingOptions& options) {
  constexpr size_t kGroup = 16;  // one reader for so many: neighbours share what it has unpacked
  constexpr size_t kCopiesKept = 128;
  std::vector<LocalMesh> meshes(blocks.size());
  ParallelFor((blocks.size() + kGroup - 1) / kGroup, 1, [&](size_t group) {
    SurfaceReader reader;
    const size_t end = std::min(blocks.size(), (group + 1) * kGroup);
    for (size_t i = group * kGroup; i < end; ++i) {
      meshes[i] = BlockMesher(map, blocks[i], options, &reader).Take();
      reader.Trim(kCopiesKept);
    }
  });
  return meshes;
}

// Joins block meshes: vertices on the same lattice edge become one.
class Stitcher {
 public:
  void Add(BlockIndex block, const LocalMesh& local) {
    std::vector<uint32_t> moved(local.mesh.vertices.size());
    for (size_t i = 0; i < moved.size(); ++i) {
      moved[i] = IndexOf(block, local.edge_slots[i], local.mesh.vertices[i]);
    }
    for (const auto& [a, b, c] : local.mesh.triangles) {
      mesh_.triangles.push_back({moved[a], moved[b], moved[c]});
    }
  }
  Mesh Take() { return std::move(mesh_); }

 private:
  // The block that owns an edge, and the edge's slot there.
  struct Key {
    BlockIndex block;
    int slot;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    size_t operator()(const Key& key) const {
      return BlockIndexHash()(key.block) ^ (static_cast<size_t>(key.slot) * 0x9E3779B185EBCA87ull);
    }
  };

  static int ToOwner(int coordinate, int32_t* block) {
    if (coordinate < kBlockSide) return coordinate;
    ++*block;
    return coordinate - kBlockSide;
  }

  uint32_t IndexOf(BlockIndex block, int slot, const MeshVertex& vertex) {
    LatticeEdge edge{slot / 3 % 9, slot / 27 % 9, slot / 243, slot % 3};
    const auto next = static_cast<uint32_t>(mesh_.vertices.size());
    const auto on_side = [&](int axis, int coordinate) {
      return edge.axis != axis && coordinate % kBlockSide == 0;
    };
    if (on_side(0, edge.x) || on_side(1, edge.y) || on_side(2, edge.z)) {
      edge.x = ToOwner(edge.x, &block.x);
      edge.y = ToOwner(edge.y, &block.y);
      edge.z = ToOwner(edge.z, &block.z);
      const auto [entry, inserted] = shared_.try_emplace(Key{block, EdgeSlot(edge)}, next);
      if (!inserted) return entry->second;
    }
    mesh_.vertices.push_back(vertex);
    return next;
  }

  Mesh mesh_;
  tsl::robin_map<Key, uint32_t, KeyHash> shared_;
};

bool HasSurfaceAround(const VoxelMap& map, BlockIndex index) {
  for (int i = 0; i < 8; ++i) {
    const Block* block = map.Find({index.x + (i & 1), index.y + (i >> 1 & 1), index.z + (i >> 2)});
    if (block != nullptr && block->surface) return true;
  }
  return false;
}

// A vertex depends on voxels up to one step beyond its cell, so on all 26 neighbours.
std::vector<BlockIndex> AffectedBlocks(const VoxelMap& map, std::span<const BlockIndex> changed) {
  std::vector<BlockIndex> near;
  near.reserve(changed.size() * 27);
  for (const BlockIndex& block : changed) {
    for (int i = 0; i < 27; ++i) {
      near.push_back({block.x + i % 3 - 1, block.y + i / 3 % 3 - 1, block.z + i / 9 - 1});
    }
  }
  SortUnique(&near);
  std::vector<BlockIndex> own(changed.begin(), changed.end());
  SortUnique(&own);
  std::erase_if(near, [&](const BlockIndex& block) {
    return !std::binary_search(own.begin(), own.end(), block) && !HasSurfaceAround(map, block);
  });
  return near;
}

}  // namespace

Mesh ExtractMesh(const SemanticMap& map, const MeshingOptions& options) {
  return ExtractMeshOf(map, BlocksWithSurface(map.voxels), options);
}

Mesh ExtractMeshOf(const SemanticMap& map, std::vector<BlockIndex> part,
                   const MeshingOptions& options) {
  const std::vector<BlockIndex> blocks = CandidateBlocks(map.voxels, part);
  const std::vector<LocalMesh> parts = MeshEach(map, blocks, options);
  Stitcher stitcher;
  for (size_t i = 0; i < blocks.size(); ++i) stitcher.Add(blocks[i], parts[i]);
  Mesh mesh = RemoveSmallComponents(stitcher.Take(), options.min_component_triangles);
  ApplyReadOut(ReadLabels(map.labels, VerticesPerLabel(mesh)), &mesh);
  return mesh;
}

MeshDelta MeshBlocks(const SemanticMap& map, std::span<const BlockIndex> changed,
                     const MeshingOptions& options) {
  const std::vector<BlockIndex> blocks = AffectedBlocks(map.voxels, changed);
  std::vector<LocalMesh> parts = MeshEach(map, blocks, options);
  const LabelReadOut read_out = ReadLabels(map.labels);
  MeshDelta delta;
  delta.revision = map.revision;
  for (size_t i = 0; i < blocks.size(); ++i) {
    ApplyReadOut(read_out, &parts[i].mesh);
    delta.blocks.push_back({blocks[i], std::move(parts[i].mesh)});
  }
  return delta;
}

}  // namespace vismap
