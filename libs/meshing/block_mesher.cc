#include "meshing/block_mesher.h"

#include <octomap/octomap_types.h>
// Needs the types of octomap_types.h.
#include <octomap/MCTables.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace vismap {
namespace {

constexpr size_t kCopiesKept = 128;  // copies of packed blocks, which neighbours share

// The corners of a cell in the order of the tables: around the lower face, then around the upper
// one.
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

// The edges of a cell: offsets of their slots from the slot of the cell.
constexpr std::array<uint16_t, 12> CellEdgeSlots() {
  std::array<uint16_t, 12> slots{};
  for (size_t i = 0; i < slots.size(); ++i) {
    const auto &a = kCorner[kEdgeEnds[i][0]], &b = kCorner[kEdgeEnds[i][1]];
    slots[i] = static_cast<uint16_t>(
        EdgeSlot({std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]),
                  a[0] != b[0] ? 0 : (a[1] != b[1] ? 1 : 2)}));
  }
  return slots;
}
constexpr std::array<uint16_t, 12> kCellEdgeSlot = CellEdgeSlots();

// Several slots of edges as a vector, so that all are computed by one addition.
using Slots = uint16_t __attribute__((vector_size(16)));

// The triangles of a cell with given corners behind the surface. All recipes have the same size, so
// that the code for a cell has no branches, which the processor could not predict.
struct Recipe {
  std::array<uint16_t, 16> corners{};  // of the triangles: offsets from the slot of the cell
  uint16_t corner_count = 0;
};

Recipe ReadRecipe(const int* row) {
  Recipe recipe;
  uint16_t corners = 0;
  for (; row[corners] >= 0; corners = static_cast<uint16_t>(corners + 3)) {
    // With corners set behind the surface, the tables' triangles are clockwise seen from free
    // space.
    for (const auto& [to, from] : {std::pair{0, 0}, std::pair{1, 2}, std::pair{2, 1}})
      recipe.corners[static_cast<size_t>(corners + to)] =
          kCellEdgeSlot[static_cast<size_t>(row[corners + from])];
  }
  recipe.corner_count = corners;
  return recipe;
}

// The row of the tables for a set of corners as CrossedEdges::CubeOf numbers them.
const int* TableRow(size_t cube) {
  size_t row = 0;
  for (size_t i = 0; i < kCorner.size(); ++i) {
    const auto& [x, y, z] = kCorner[i];
    row |= (cube >> (x + 2 * y + 4 * z) & 1) << i;
  }
  return octomap::triTable[row];
}

std::array<Recipe, 256> ReadRecipes() {
  std::array<Recipe, 256> recipes;
  for (size_t i = 0; i < recipes.size(); ++i) recipes[i] = ReadRecipe(TableRow(i));
  return recipes;
}
const std::array<Recipe, 256> kRecipes = ReadRecipes();

// Writes the slots of the corners of a cell's triangles. Always writes 16 slots.
inline void AddCorners(const Recipe& recipe, size_t cell, uint16_t* slots_out) {
  const auto from = static_cast<uint16_t>(cell);
  for (size_t i = 0; i < recipe.corners.size(); i += sizeof(Slots) / sizeof(uint16_t)) {
    Slots slots;
    std::memcpy(&slots, &recipe.corners[i], sizeof(slots));
    slots += from;
    std::memcpy(slots_out + i, &slots, sizeof(slots));
  }
}

}  // namespace

BlockMesher::BlockMesher(const MeshingJob& job)
    : job_(job),
      jump_(static_cast<int>(
          std::lround(std::clamp(job.jump_fraction, 0.0, 2.0) * kTruncationSteps))),
      walk_(job.views),
      vertex_maker_(grid_, job.voxel_size, job.shown) {}

inline bool BlockMesher::IsJump(size_t slot) const {
  const int16_t* lower = grid_.Lower(slot);
  const int from = *lower, to = lower[AxisStep(slot / kAxisSlots)];
  return std::max(from, to) >= jump_ && std::min(from, to) <= -jump_;
}

bool BlockMesher::MayCrossJumps() const {
  int farthest = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t step = AxisStep(axis);
    for (size_t i = edges_.FirstAlong(axis); i < edges_.FirstAlong(axis + 1); ++i) {
      const int16_t* lower = grid_.Lower(edges_.slots()[i]);
      farthest = std::max(farthest, std::abs(*lower - lower[step]));
    }
  }
  return farthest >= 2 * jump_;
}

void BlockMesher::Find(BlockIndex block) {
  edges_.Clear();
  walk_.GoTo(block);
  if (!FindSurfaceCells(walk_, &cells_)) return;  // no surface in this block
  walk_.FindLower();
  const BlockView* next = walk_.Next();
  if (next != nullptr && next->voxels != nullptr) CellGrid::Prefetch(*next->voxels);
  reader_.Trim(kCopiesKept);
  const CellBox box = BoxAround(cells_);
  grid_.Fill(walk_, box, &reader_);
  edges_.ReadCorners(walk_, box.z);
  edges_.List(cells_);
  if (MayCrossJumps()) LeaveOutJumps();
}

Mesh BlockMesher::MakeMesh() {
  Mesh mesh;
  if (edges_.slots().empty()) return mesh;  // no surface in this block
  size_t count = 0;
  edges_.ForEachCell([&](size_t cell) {
    const Recipe& recipe = kRecipes[edges_.CubeOf(cell)];
    AddCorners(recipe, cell, &corners_[count]);
    count += recipe.corner_count;
  });
  const auto triangles = std::span(triangles_).first(count / 3);
  const uint16_t* corner = corners_.data();
  for (auto& triangle : triangles) {
    for (uint32_t& number : triangle) number = edges_.NumberOf(*corner++);
  }
  mesh.triangles.assign(triangles.begin(), triangles.end());
  vertex_maker_.Make(walk_.block(), edges_, &mesh.vertices);
  return mesh;
}

void BlockMesher::LeaveOutJumps() {
  edges_.ForEachCell([&](size_t cell) {
    const Recipe& recipe = kRecipes[edges_.CubeOf(cell)];
    const auto corners = std::span(recipe.corners).first(recipe.corner_count);
    const bool crosses = std::any_of(corners.begin(), corners.end(),
                                     [&](uint16_t step) { return IsJump(cell + step); });
    const LatticeEdge at = EdgeOfSlot(static_cast<int>(cell));
    if (crosses) cells_[static_cast<size_t>(at.z)] &= ~(uint64_t{1} << (at.x + kBlockSide * at.y));
  });
  edges_.List(cells_);
}

}  // namespace vismap
