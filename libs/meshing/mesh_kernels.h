#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "map/block.h"
#include "meshing/lattice_edge.h"

namespace vismap {

// The loops of meshing over many voxels, cells or vertices (marching cubes, Lorensen and Cline
// 1987). They have no branches, so that the compiler vectorises them, and are compiled once per
// SIMD level with equal results.
//
// Symbols, of a voxel: D = mean distance [τ / N], W = weight [1 / S], n = number of observations;
// N = kTruncationSteps, S = kWeightScale. v = voxel size [m].
//
// Every kernel names its twin: plain code for one voxel, cell or vertex in tests/support/naive,
// mesh_block.cc or vertex_look.cc. The tests in tests/meshing/naive_mesh_test.cc hold the two
// equal, bit for bit: MeshBlocks.EqualsTheNaiveOneAfterEveryFrame (triangles and positions),
// MeshBlocks.NormalsEqualTheNaiveOnes, MeshBlocks.ColoursLabelsAndCountsEqualTheNaiveOnes.

/// Which voxels of a block are observed well enough, and which lie behind the surface: bit x of
/// byte y of word z. Voxels behind are observed.
struct VoxelSigns {
  std::array<uint64_t, kBlockSide> observed{}, behind{};
};

/// What counts as observed.
struct ObservationGate {
  uint16_t weight = 0;        ///< above it, in steps of 1 / kWeightScale
  uint16_t observations = 0;  ///< at least so many frames
};
/// observed = (W > gate.weight and n >= gate.observations); behind = (observed and D < 0). Twins:
/// SeenDistance, Cell::Behind.
void ReadSigns(const SurfaceVoxels& voxels, const ObservationGate& gate, VoxelSigns& signs);

/// Cells of a block that the surface passes through: bit x of byte y of word z. A cell reaches from
/// a voxel to the next one along each axis.
using CellBits = std::array<uint64_t, kBlockSide>;
/// Bits of the voxels of the layers z = 0..8 of a block, then of those behind it along x, along y,
/// and along both.
using LatticeBits = std::array<std::array<uint64_t, kBlockSide + 1>, 4>;
/// The cells whose eight corners are all observed, with at least one behind the surface and at
/// least one in front of it. Twins: ReadCell, Cell::Crossed.
void MarkSurfaceCells(const LatticeBits& observed, const LatticeBits& behind, CellBits& cells);

/// A cube of distances, x fastest, in steps of truncation / kTruncationSteps; kUnseenDistance = not
/// observed. Its strides are those of edge slots, so a slot's lower end is found without dividing.
inline constexpr int kGridLow = -1;  ///< coordinates are -1..9: a block, one before, two behind it
inline constexpr int kGridSide = kBlockSide + 3;
inline constexpr int kGridRow = kSlotStride;
inline constexpr int kGridLayer = kSlotStride * kSlotStride;
inline constexpr int16_t kUnseenDistance = std::numeric_limits<int16_t>::min();
using DistanceGrid = std::array<int16_t, kGridSide * kGridLayer>;
constexpr int GridOffset(int x, int y, int z) {
  return (x - kGridLow) + kGridRow * (y - kGridLow) + kGridLayer * (z - kGridLow);
}

/// Distances of a block, and which of them count: observed as in VoxelSigns.
struct SeenBlock {
  const int16_t* distances;
  const uint64_t* observed;
};
/// The blocks of one height around a block: (x, y), each -1..1, is at x + 1 + 3 (y + 1).
using SeenBlocks = std::array<SeenBlock, 9>;
/// Copies the layers `from` <= z < `to` of blocks to the grid, the first of them to layer `layer`:
/// D where the voxel is observed, kUnseenDistance elsewhere. Twin: SeenDistance.
void CopySeen(const SeenBlocks& blocks, int from, int to, int layer, DistanceGrid& grid);

/// Distances at a voxel and at its neighbours: itself, then lower and upper along x, y, z.
inline constexpr std::array<int, 7> kStar = {0,        -1,          1,         -kGridRow,
                                             kGridRow, -kGridLayer, kGridLayer};

/// Some vertices at a time, one array per component. The loops run over whole groups of them.
inline constexpr size_t kVertexLanes = 64;
inline constexpr size_t kVertexGroup = 16;
struct VertexLanes {
  template <typename T>
  using Lane = std::array<T, kVertexLanes>;
  alignas(64) Lane<uint16_t> slot{};  ///< of the vertex's edge, as numbered by EdgeSlot
  alignas(64) std::array<Lane<int16_t>, 7> lower{};  ///< star of the edge's lower end
  alignas(64) std::array<Lane<int16_t>, 7> upper{};  ///< and of its upper end
  alignas(64) Lane<uint32_t> lower_color{};          ///< r | g << 8 | b << 16, and anything above
  alignas(64) Lane<uint32_t> upper_color{};          ///< the same
  alignas(64) Lane<uint32_t> lower_end{};            ///< set by LocateEnds
  alignas(64) Lane<uint32_t> upper_end{};            ///< the same
  alignas(64) Lane<uint32_t> nearer_end{};  ///< the one of them that the vertex is nearer to
  alignas(64) Lane<float> t{};              ///< 0 = at the lower end, 1 = at the upper end
  alignas(64) std::array<Lane<float>, 3> normal{};    ///< unit, W
  alignas(64) std::array<Lane<float>, 3> position{};  ///< W [m]
  alignas(64) Lane<uint32_t> color{};                 ///< as above, interpolated
};
/// The voxel at an end of an edge: its offset in the lower half of a word, and in the upper half
/// which of the block (0) and the seven behind it along x (1), y (2) and z (4) has it.
inline constexpr int kEndBits = 16;
/// Computes lower_end and upper_end from `slot`: the voxels at the ends of edges. Twin: EdgeOf.
void LocateEnds(size_t groups, VertexLanes& vertices);
/// Where voxel centres are along each axis: (first + i) * step [m].
struct VoxelCenters {
  std::array<double, 3> first;
  double step;
};
/// Computes t, nearer_end, normal and position from slots, ends and stars. With a and b = lower and
/// upper end of the edge:
///   t = D_a / (D_a - D_b), at least 0.01 and at most 0.99: where D is 0 between the ends
///   position = v (a + (1/2, 1/2, 1/2) + t (b - a))
///   g = (1 - t) grad D(a) + t grad D(b), by central differences, one-sided beside voxels that are
///   not observed; normal = g / |g|, or along the edge toward free space when |g| <= 1
/// Twins: Crossing (position), NormalAt, LabelAtEnds (nearer end).
void PlaceVertices(size_t groups, const VoxelCenters& centers, VertexLanes& vertices);
/// color = (color_a (256 - s) + color_b s + 128) / 256 per channel, with s = round(256 t). Twin:
/// ColorAt.
void BlendColors(size_t groups, VertexLanes& vertices);

/// Rows of bits of the lattice around a block: bit x of row y + kBitRows * z. Rows without voxels
/// or cells are 0, so those past the highest y serve as the one before the lowest of the next
/// layer.
inline constexpr int kBitRows = kSlotStride;  ///< of a layer

/// Which lattice edges along one axis each; bits of their lower ends.
struct EdgeRows {
  uint16_t *x, *y, *z;
};
/// Finds the edges of the given cells whose ends are on different sides of the surface,
/// behind(a) != behind(b), in `rows` rows. Reads behind[0 .. rows + kBitRows) and
/// cells[-kBitRows - 1 .. rows). Twin: Cell::Crossed.
void CrossEdges(const uint16_t* behind, const uint16_t* cells, int rows, const EdgeRows& out);
/// Turns eight bytes into eight rows of bits; bit 8 of a row is the lowest bit of its byte in
/// `beyond`. Only moves bits, so it has no twin; every mesh of the tests above passes through it.
void SpreadRows(uint64_t bytes, uint64_t beyond, uint16_t* rows_out);

}  // namespace vismap
