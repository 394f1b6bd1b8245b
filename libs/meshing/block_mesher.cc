#include "meshing/block_mesher.h"

#include <octomap/octomap_types.h>
// Needs the types before it.
#include <octomap/MCTables.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace vismap {
namespace {

constexpr uint16_t kNoVertex = std::numeric_limits<uint16_t>::max();
constexpr size_t kCopiesKept = 128;  // of packed blocks: neighbours share them

// Corner order of the tables (Bourke): around the lower face, then around the upper one.
constexpr std::array<std::array<int, 3>, 8> kCorner = {
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
constexpr std::array<std::array<size_t, 2>, 12> kEdgeEnds = {{{0, 1},
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

constexpr std::array<int, 8> CornerSteps() {
  std::array<int, 8> steps{};
  for (size_t i = 0; i < steps.size(); ++i)
    steps[i] = GridOffset(kCorner[i][0], kCorner[i][1], kCorner[i][2]) - GridOffset(0, 0, 0);
  return steps;
}
constexpr std::array<int, 8> kCornerStep = CornerSteps();  // in the grid, from the lowest corner

// The edges of a cell as lattice edges relative to its lowest corner.
constexpr std::array<LatticeEdge, 12> CellEdges() {
  std::array<LatticeEdge, 12> edges{};
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto &a = kCorner[kEdgeEnds[i][0]], &b = kCorner[kEdgeEnds[i][1]];
    edges[i] = {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]),
                a[0] != b[0] ? 0 : (a[1] != b[1] ? 1 : 2)};
  }
  return edges;
}
constexpr std::array<LatticeEdge, 12> kCellEdge = CellEdges();
constexpr std::array<int, 12> CellEdgeSlots() {
  std::array<int, 12> slots{};
  for (size_t i = 0; i < slots.size(); ++i) slots[i] = EdgeSlot(kCellEdge[i]);
  return slots;
}
constexpr std::array<int, 12> kCellEdgeSlot = CellEdgeSlots();

}  // namespace

BlockMesher::BlockMesher(const MeshingJob& job)
    : job_(job),
      jump_(static_cast<float>(std::lround(std::clamp(job.jump_fraction, 0.0, 2.0) * 32767))),
      walk_(job.views.views()),
      vertex_maker_(grid_, job.voxel_size, job.shown) {
  vertex_of_slot_.fill(kNoVertex);
}

const std::vector<std::array<uint32_t, 3>>& BlockMesher::Find(BlockIndex block) {
  edges_.clear();
  triangles_.clear();
  CellBits cells;
  walk_.GoTo(block);
  if (!FindSurfaceCells(walk_, &cells)) return triangles_;
  walk_.FindLower();
  reader_.Trim(kCopiesKept);
  grid_.Fill(walk_, &reader_);
  for (int z = 0; z < kBlockSide; ++z) {
    for (uint64_t bits = cells[static_cast<size_t>(z)]; bits != 0; bits &= bits - 1) {
      const int cell = std::countr_zero(bits);
      MeshCell(cell % kBlockSide, cell / kBlockSide, z);
    }
  }
  for (const LatticeEdge& edge : edges_)
    vertex_of_slot_[static_cast<size_t>(EdgeSlot(edge))] = kNoVertex;
  return triangles_;
}

void BlockMesher::MakeVertices(std::vector<MeshVertex>* vertices) {
  vertex_maker_.Make(walk_.block(), edges_, vertices);
}

inline uint32_t BlockMesher::VertexOn(size_t edge, const LatticeEdge& cell, int cell_slot) {
  const LatticeEdge& e = kCellEdge[edge];
  uint16_t& vertex = vertex_of_slot_[static_cast<size_t>(cell_slot + kCellEdgeSlot[edge])];
  if (vertex == kNoVertex) {
    vertex = static_cast<uint16_t>(edges_.size());
    edges_.push_back({e.x + cell.x, e.y + cell.y, e.z + cell.z, e.axis});
  }
  return vertex;
}

void BlockMesher::MeshCell(int x, int y, int z) {
  const float* corner = grid_.At(x, y, z);
  size_t cube = 0;
  float lowest = 0, highest = 0;
  for (size_t i = 0; i < 8; ++i) {
    const float distance = corner[kCornerStep[i]];
    cube |= static_cast<size_t>(distance < 0) << i;
    lowest = std::min(lowest, distance);
    highest = std::max(highest, distance);
  }
  if (highest >= jump_ && lowest <= -jump_ && CrossesJump(cube, corner)) return;
  const int* row = octomap::triTable[cube];
  const LatticeEdge cell{x, y, z};
  const int slot = EdgeSlot(cell);
  const auto vertex = [&](int i) { return VertexOn(static_cast<size_t>(row[i]), cell, slot); };
  // The tables turn clockwise for corners that are set; ours are set behind the surface.
  for (int i = 0; row[i] >= 0; i += 3) {
    const uint32_t a = vertex(i), b = vertex(i + 2), c = vertex(i + 1);
    triangles_.push_back({a, b, c});
  }
}

bool BlockMesher::CrossesJump(size_t cube, const float* corner) const {
  for (const auto& [a, b] : kEdgeEnds) {
    if (((cube >> a) & 1) == ((cube >> b) & 1)) continue;
    const float from = corner[kCornerStep[a]], to = corner[kCornerStep[b]];
    if (std::max(from, to) >= jump_ && std::min(from, to) <= -jump_) return true;
  }
  return false;
}

}  // namespace vismap
