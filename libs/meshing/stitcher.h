#pragma once

#include <tsl/robin_map.h>

#include <vector>

#include "meshing/lattice_edge.h"
#include "meshing/mesh.h"

namespace vismap {

/// The mesh of one block, with the slot of the lattice edge of each vertex (see EdgeSlot).
struct LocalMesh {
  Mesh mesh;
  std::vector<uint16_t> edge_slots;
};

/// Joins the meshes of blocks to one: vertices on the same lattice edge become one vertex.
class Stitcher {
 public:
  void Add(BlockIndex block, const LocalMesh& local);
  /// Returns the mesh, to be called once.
  Mesh Finish() { return std::move(mesh_); }

 private:
  // The block that owns an edge, and the slot of the edge there.
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

  uint32_t IndexOf(BlockIndex block, LatticeEdge edge, const MeshVertex& vertex);

  Mesh mesh_;
  std::vector<uint32_t> moved_;  // indices in mesh_ of the vertices of one block
  tsl::robin_map<Key, uint32_t, KeyHash> shared_;
};

}  // namespace vismap
