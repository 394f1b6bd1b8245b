#pragma once

#include <array>
#include <cstdint>

#include "volume/block.h"

namespace vismap {

// The loops of meshing that run over many voxels or vertices, free of branches so that the compiler
// vectorises them. Each is compiled once per SIMD level with equal results.

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
void ReadSigns(const SurfaceVoxels& voxels, const ObservationGate& gate, VoxelSigns& signs);

/// A cube of distances, x fastest, in steps of truncation / 32767; kUnseenDistance = not observed.
inline constexpr int kGridLow = -1;  ///< coordinates are -1..9: a block, one before, two behind it
inline constexpr int kGridSide = kBlockSide + 3;
inline constexpr float kUnseenDistance = 1e6F;
using DistanceGrid = std::array<float, kGridSide * kGridSide * kGridSide>;
constexpr int GridOffset(int x, int y, int z) {
  return (x - kGridLow) + kGridSide * ((y - kGridLow) + kGridSide * (z - kGridLow));
}

/// Copies a layer of eight rows of eight voxels, or of its first `rows` rows. `observed` = a bit
/// per voxel, `first` = place of the first one in the grid.
void CopyLayer(const int16_t* distances, uint64_t observed, int rows, float* first);

/// Distances at a voxel and at its neighbours: itself, then lower and upper along x, y, z.
inline constexpr std::array<int, 7> kStar = {
    0, -1, 1, -kGridSide, kGridSide, -kGridSide* kGridSide, kGridSide* kGridSide};

/// Some vertices at a time, one array per component.
inline constexpr int kVertexLanes = 64;
struct VertexLanes {
  template <typename T>
  using Lane = std::array<T, kVertexLanes>;
  alignas(64) std::array<Lane<float>, 7> lower{};   ///< star of the lower end of the vertex's edge
  alignas(64) std::array<Lane<float>, 7> upper{};   ///< and of its upper end
  alignas(64) Lane<int32_t> axis{};                 ///< of the edge
  alignas(64) Lane<float> t{};                      ///< place between the ends, [0.01, 0.99]
  alignas(64) std::array<Lane<float>, 3> normal{};  ///< unit, W
};
/// Computes places and normals from the rest.
void PlaceVertices(VertexLanes& vertices);

}  // namespace vismap
