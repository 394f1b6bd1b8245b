#include "meshing/mesh_kernels.h"

#include <cmath>
#include <cstring>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

constexpr int kRows = kBlockSide * kBlockSide;

// Plain arrays and scalars only: what these loops see decides whether they vectorise.
VISMAP_VECTOR_CLONES void FlagVoxels(const int16_t* distances, const uint16_t* weights,
                                     const uint8_t* observations, uint16_t weight_gate,
                                     uint16_t observation_gate, uint8_t* __restrict observed_out,
                                     uint8_t* __restrict behind_out) {
  for (int i = 0; i < kBlockVoxels; ++i) {
    const uint16_t seen = observations[i];
    const auto heavy = static_cast<uint8_t>(weights[i] > weight_gate ? 1 : 0);
    const auto often = static_cast<uint8_t>(seen >= observation_gate ? 1 : 0);
    const auto negative = static_cast<uint8_t>(distances[i] < 0 ? 1 : 0);
    observed_out[i] = heavy & often;
    behind_out[i] = heavy & often & negative;
  }
}

// Eight bytes of 0 or 1 each to eight bits, in each word.
VISMAP_VECTOR_CLONES void PackRows(const uint64_t* flags, uint64_t* __restrict rows_out) {
  for (int row = 0; row < kRows; ++row) {
    const uint64_t pairs = flags[row] | flags[row] >> 7;
    const uint64_t fours = pairs | pairs >> 14;
    rows_out[row] = (fours | fours >> 28) & 0xFF;
  }
}

constexpr std::array<int32_t, kBlockSide> kBit = {1, 2, 4, 8, 16, 32, 64, 128};

VISMAP_VECTOR_CLONES void CopySeen(const int16_t* distances, uint64_t observed, int rows,
                                   float* __restrict out) {
  for (int row = 0; row < rows; ++row) {
    const auto bits = static_cast<int32_t>(observed >> (kBlockSide * row) & 0xFF);
    for (int x = 0; x < kBlockSide; ++x) {
      const auto distance = static_cast<float>(distances[row * kBlockSide + x]);
      out[row * kGridSide + x] =
          (bits & kBit[static_cast<size_t>(x)]) != 0 ? distance : kUnseenDistance;
    }
  }
}

// Central difference in steps per voxel; one-sided at the rim of what was seen.
inline float Slope(float here, float low, float high) {
  const float below = low < kUnseenDistance ? low : here;
  const float above = high < kUnseenDistance ? high : here;
  const float half = low < kUnseenDistance ? 0.5F : 1.0F;
  const float factor = high < kUnseenDistance ? half : 1.0F;
  return (above - below) * factor;
}

VISMAP_VECTOR_CLONES void Place(const float* a, const float* b, const int32_t* axis,
                                float* __restrict t_out, float* __restrict normal_out) {
  constexpr int kN = kVertexLanes;
  for (int i = 0; i < kN; ++i) {
    const float from = a[i], to = b[i];
    const float exact = from / (from - to);
    const float low = exact < 0.01F ? 0.01F : exact;
    const float t = low > 0.99F ? 0.99F : low;
    const float x =
        Slope(from, a[kN + i], a[2 * kN + i]) * (1 - t) + Slope(to, b[kN + i], b[2 * kN + i]) * t;
    const float y = Slope(from, a[3 * kN + i], a[4 * kN + i]) * (1 - t) +
                    Slope(to, b[3 * kN + i], b[4 * kN + i]) * t;
    const float z = Slope(from, a[5 * kN + i], a[6 * kN + i]) * (1 - t) +
                    Slope(to, b[5 * kN + i], b[6 * kN + i]) * t;
    const float length = std::sqrt(x * x + (y * y + z * z));
    // No slope to speak of: toward the end that lies in front of the surface.
    const float sign = from < 0 ? 1.0F : -1.0F;
    const float along_x = axis[i] == 0 ? sign : sign * 0.0F;
    const float along_y = axis[i] == 1 ? sign : sign * 0.0F;
    const float along_z = axis[i] == 2 ? sign : sign * 0.0F;
    t_out[i] = t;
    normal_out[i] = length > 1 ? x / length : along_x;
    normal_out[kN + i] = length > 1 ? y / length : along_y;
    normal_out[2 * kN + i] = length > 1 ? z / length : along_z;
  }
}

void PackSigns(const uint8_t* flags, std::array<uint64_t, kBlockSide>& signs) {
  uint64_t words[kRows], rows[kRows];
  std::memcpy(words, flags, sizeof(words));
  PackRows(words, rows);
  for (size_t z = 0; z < kBlockSide; ++z) {
    signs[z] = 0;
    for (size_t y = 0; y < kBlockSide; ++y) signs[z] |= rows[8 * z + y] << (8 * y);
  }
}

}  // namespace

void ReadSigns(const SurfaceVoxels& voxels, const ObservationGate& gate, VoxelSigns& signs) {
  alignas(64) uint8_t observed[kBlockVoxels], behind[kBlockVoxels];
  FlagVoxels(voxels.distance.data(), voxels.weight.data(), voxels.observations.data(), gate.weight,
             gate.observations, observed, behind);
  PackSigns(observed, signs.observed);
  PackSigns(behind, signs.behind);
}

void CopyLayer(const int16_t* distances, uint64_t observed, int rows, float* first) {
  CopySeen(distances, observed, rows, first);
}

void PlaceVertices(VertexLanes& vertices) {
  Place(vertices.lower.front().data(), vertices.upper.front().data(), vertices.axis.data(),
        vertices.t.data(), vertices.normal.front().data());
}

}  // namespace vismap
