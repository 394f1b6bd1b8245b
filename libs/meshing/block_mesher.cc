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

// The edges of a cell, as slots counted from its own.
constexpr std::array<size_t, 12> CellEdgeSlots() {
  std::array<size_t, 12> slots{};
  for (size_t i = 0; i < slots.size(); ++i) {
    const auto &a = kCorner[kEdgeEnds[i][0]], &b = kCorner[kEdgeEnds[i][1]];
    slots[i] = static_cast<size_t>(
        EdgeSlot({std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2]),
                  a[0] != b[0] ? 0 : (a[1] != b[1] ? 1 : 2)}));
  }
  return slots;
}
constexpr std::array<size_t, 12> kCellEdgeSlot = CellEdgeSlots();

// What a cell adds to the mesh, by which of its corners are behind the surface. Padded, so that
// most cells run through the same code: how much a cell has cannot be foreseen.
struct Recipe {
  static constexpr size_t kMostEdges = 6, kMostTriangles = 3;  // of most cells
  std::array<uint8_t, 12> edges{};    // crossed, as the triangles name them first; repeated
  std::array<uint8_t, 15> corners{};  // of the triangles: edges
  uint8_t edge_count = 0, triangle_count = 0;
};

Recipe ReadRecipe(const int* row) {
  Recipe recipe;
  for (size_t i = 0; row[i] >= 0; i += 3) {
    // The tables turn clockwise for corners that are set; ours are set behind the surface.
    const std::array<int, 3> turned{row[i], row[i + 2], row[i + 1]};
    for (size_t corner = 0; corner < 3; ++corner) {
      const auto edge = static_cast<uint8_t>(turned[corner]);
      const auto end = recipe.edges.begin() + recipe.edge_count;
      if (std::find(recipe.edges.begin(), end, edge) == end)
        recipe.edges[recipe.edge_count++] = edge;
      recipe.corners[i + corner] = edge;
    }
    ++recipe.triangle_count;
  }
  const uint8_t first = recipe.edges[0];
  std::fill(recipe.edges.begin() + recipe.edge_count, recipe.edges.end(), first);
  std::fill(recipe.corners.begin() + 3 * recipe.triangle_count, recipe.corners.end(), first);
  return recipe;
}

std::array<Recipe, 256> ReadRecipes() {
  std::array<Recipe, 256> recipes;
  for (size_t i = 0; i < recipes.size(); ++i) recipes[i] = ReadRecipe(octomap::triTable[i]);
  return recipes;
}
const std::array<Recipe, 256> kRecipes = ReadRecipes();

// Those with cells.
CellGrid::Layers LayersOf(const CellBits& cells) {
  CellGrid::Layers layers;
  while (cells[static_cast<size_t>(layers.from)] == 0) ++layers.from;
  while (cells[static_cast<size_t>(layers.to - 1)] == 0) --layers.to;
  return layers;
}

}  // namespace

BlockMesher::BlockMesher(const MeshingJob& job)
    : job_(job),
      jump_(static_cast<float>(std::lround(std::clamp(job.jump_fraction, 0.0, 2.0) * 32767))),
      walk_(job.views.views()),
      vertex_maker_(grid_, job.voxel_size, job.shown) {
  vertex_of_slot_.fill(kNoVertex);
}

void BlockMesher::Find(BlockIndex block) {
  vertices_ = triangle_count_ = 0;
  CellBits cells;
  walk_.GoTo(block);
  if (!FindSurfaceCells(walk_, &cells)) return;
  walk_.FindLower();
  reader_.Trim(kCopiesKept);
  grid_.Fill(walk_, LayersOf(cells), &reader_);
  for (int z = 0; z < kBlockSide; ++z) {
    for (uint64_t bits = cells[static_cast<size_t>(z)]; bits != 0; bits &= bits - 1) {
      const int cell = std::countr_zero(bits);
      MeshCell(cell % kBlockSide, cell / kBlockSide, z);
    }
  }
  for (const uint16_t slot : edge_slots()) vertex_of_slot_[slot] = kNoVertex;
}

Mesh BlockMesher::MakeMesh() {
  const auto triangles = std::span(triangles_).first(triangle_count_);
  Mesh mesh;
  mesh.triangles.assign(triangles.begin(), triangles.end());
  vertex_maker_.Make(walk_.block(), edge_slots(), &mesh.vertices);
  return mesh;
}

// Free of branches: whether a vertex is new cannot be foreseen.
inline uint32_t BlockMesher::VertexOn(size_t slot) {
  const uint16_t known = vertex_of_slot_[slot];
  const bool is_new = known == kNoVertex;
  const uint16_t vertex = is_new ? static_cast<uint16_t>(vertices_) : known;
  slots_[vertices_] = static_cast<uint16_t>(slot);
  vertices_ += is_new ? 1 : 0;
  vertex_of_slot_[slot] = vertex;
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
  AddCell(cube, static_cast<size_t>(EdgeSlot({x, y, z})));
}

void BlockMesher::AddCell(size_t cube, size_t cell_slot) {
  const Recipe& recipe = kRecipes[cube];
  std::array<uint32_t, 12> vertices;
  const auto add_edge = [&](size_t i) {
    const size_t edge = recipe.edges[i];
    vertices[edge] = VertexOn(cell_slot + kCellEdgeSlot[edge]);
  };
  for (size_t i = 0; i < Recipe::kMostEdges; ++i) add_edge(i);
  for (size_t i = Recipe::kMostEdges; i < recipe.edge_count; ++i) add_edge(i);
  const auto add_triangle = [&](size_t i) {
    const uint8_t* corner = &recipe.corners[3 * i];
    triangles_[triangle_count_ + i] = {vertices[corner[0]], vertices[corner[1]],
                                       vertices[corner[2]]};
  };
  for (size_t i = 0; i < Recipe::kMostTriangles; ++i) add_triangle(i);
  for (size_t i = Recipe::kMostTriangles; i < recipe.triangle_count; ++i) add_triangle(i);
  triangle_count_ += recipe.triangle_count;
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
