#include "meshing/stitcher.h"

namespace vismap {
namespace {

// Edges on the upper side of a block belong to its upper neighbour.
int ToOwner(int coordinate, int32_t* block) {
  if (coordinate < kBlockSide) return coordinate;
  ++*block;
  return coordinate - kBlockSide;
}

}  // namespace

void Stitcher::Add(BlockIndex block, const LocalMesh& local) {
  moved_.resize(local.mesh.vertices.size());
  for (size_t i = 0; i < moved_.size(); ++i)
    moved_[i] = IndexOf(block, EdgeOfSlot(local.edge_slots[i]), local.mesh.vertices[i]);
  for (const auto& [a, b, c] : local.mesh.triangles)
    mesh_.triangles.push_back({moved_[a], moved_[b], moved_[c]});
}

uint32_t Stitcher::IndexOf(BlockIndex block, LatticeEdge edge, const MeshVertex& vertex) {
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

}  // namespace vismap
