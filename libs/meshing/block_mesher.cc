#include "meshing/block_mesher.h"

#include <octomap/octomap_types.h>
// Needs the types before it.
#include <octomap/MCTables.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace vismap {
namespace {

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

// The edges of a cell, as steps of slots from its own.
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

// What a cell adds to the mesh, by which of its corners are behind the surface. Padded, so that
// most cells run through the same code: how much a cell has cannot be foreseen.
struct Recipe {
  static constexpr size_t kMostTriangles = 3;  // of most cells
  std::array<uint16_t, 15> corners{};          // of the triangles: steps of slots from the cell's
  uint8_t triangle_count = 0;
};

Recipe ReadRecipe(const int* row) {
  Recipe recipe;
  size_t corners = 0;
  for (; row[corners] >= 0; corners += 3) {
    // The tables turn clockwise for corners that are set; ours are set behind the surface.
    for (const auto& [to, from] : {std::pair{0, 0}, std::pair{1, 2}, std::pair{2, 1}})
      recipe.corners[corners + to] = kCellEdgeSlot[static_cast<size_t>(row[corners + from])];
  }
  std::fill(recipe.corners.begin() + corners, recipe.corners.end(), recipe.corners[0]);
  recipe.triangle_count = static_cast<uint8_t>(corners / 3);
  return recipe;
}

// The row of the tables for a cube as CrossedEdges numbers it.
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

template <typename Visit>
void ForEachCell(const CellBits& cells, const Visit& visit) {
  for (int z = 0; z < kBlockSide; ++z) {
    for (uint64_t bits = cells[static_cast<size_t>(z)]; bits != 0; bits &= bits - 1) {
      const int cell = std::countr_zero(bits);
      visit(cell % kBlockSide, cell / kBlockSide, z);
    }
  }
}

}  // namespace

BlockMesher::BlockMesher(const MeshingJob& job)
    : job_(job),
      jump_(static_cast<int>(std::lround(std::clamp(job.jump_fraction, 0.0, 2.0) * 32767))),
      walk_(job.views),
      vertex_maker_(grid_, job.voxel_size, job.shown) {}

inline bool BlockMesher::IsJump(size_t slot) const {
  const int16_t* lower = grid_.Lower(slot);
  const int from = *lower, to = lower[AxisStep(slot / kAxisSlots)];
  return std::max(from, to) >= jump_ && std::min(from, to) <= -jump_;
}

bool BlockMesher::MayCrossJumps() const {
  int farthest = 0;
  ForEachAxis(edges_.slots(), [&](size_t axis, std::span<const uint16_t> slots) {
    const size_t step = AxisStep(axis);
    for (const uint16_t slot : slots) {
      const int16_t* lower = grid_.Lower(slot);
      farthest = std::max(farthest, std::abs(*lower - lower[step]));
    }
  });
  return farthest >= 2 * jump_;
}

void BlockMesher::Find(BlockIndex block) {
  edges_.Clear();
  walk_.GoTo(block);
  if (!FindSurfaceCells(walk_, &cells_)) return;
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
  if (edges_.slots().empty()) return mesh;
  size_t triangles = 0;
  ForEachCell(cells_, [&](int x, int y, int z) {
    const Recipe& recipe = kRecipes[edges_.CubeOf(x, y, z)];
    const auto cell = static_cast<size_t>(EdgeSlot({x, y, z}));
    const auto corner = [&](size_t i) -> uint32_t {
      return edges_.NumberOf(cell + recipe.corners[i]);
    };
    const auto add = [&](size_t i) {
      triangles_[triangles + i] = {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)};
    };
    for (size_t i = 0; i < Recipe::kMostTriangles; ++i) add(i);
    for (size_t i = Recipe::kMostTriangles; i < recipe.triangle_count; ++i) add(i);
    triangles += recipe.triangle_count;
  });
  const auto made = std::span(triangles_).first(triangles);
  mesh.triangles.assign(made.begin(), made.end());
  vertex_maker_.Make(walk_.block(), edges_.slots(), &mesh.vertices);
  return mesh;
}

void BlockMesher::LeaveOutJumps() {
  ForEachCell(CellBits(cells_), [&](int x, int y, int z) {
    const Recipe& recipe = kRecipes[edges_.CubeOf(x, y, z)];
    const auto cell = static_cast<size_t>(EdgeSlot({x, y, z}));
    const auto corners = std::span(recipe.corners).first(3u * recipe.triangle_count);
    const bool crosses = std::any_of(corners.begin(), corners.end(),
                                     [&](uint16_t step) { return IsJump(cell + step); });
    if (crosses) cells_[static_cast<size_t>(z)] &= ~(uint64_t{1} << (x + kBlockSide * y));
  });
  edges_.List(cells_);
}

}  // namespace vismap
