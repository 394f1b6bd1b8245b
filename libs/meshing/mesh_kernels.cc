#include "meshing/mesh_kernels.h"

#include <cmath>
#include <cstring>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

constexpr int kRows = kBlockSide * kBlockSide;

// Plain arrays and scalars only: what these loops see decides whether they vectorise.
VISMAP_VECTOR_CLONES void FlagVoxels(const int16_t* distances, const uint16_t* weights,
                                     uint16_t gate, uint8_t* __restrict observed_out,
                                     uint8_t* __restrict behind_out) {
  for (int i = 0; i < kBlockVoxels; ++i) {
    const auto heavy = static_cast<uint8_t>(weights[i] > gate ? 1 : 0);
    const auto negative = static_cast<uint8_t>(distances[i] < 0 ? 1 : 0);
    observed_out[i] = heavy;
    behind_out[i] = heavy & negative;
  }
}

VISMAP_VECTOR_CLONES void UnflagRare(const uint8_t* observations, uint16_t gate,
                                     uint8_t* __restrict observed, uint8_t* __restrict behind) {
  for (int i = 0; i < kBlockVoxels; ++i) {
    const uint16_t seen = observations[i];
    const auto often = static_cast<uint8_t>(seen >= gate ? 1 : 0);
    observed[i] &= often;
    behind[i] &= often;
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

constexpr uint64_t kFirstOfRows = 0x0101010101010101u;  // x = 0 of the rows y = 0..7
constexpr uint64_t kFirstRow = 0xFF;

// Of every voxel of a layer the one next to it along x.
inline uint64_t NextAlongX(uint64_t own, uint64_t beyond) {
  return ((own >> 1) & ~(kFirstOfRows << 7)) | ((beyond & kFirstOfRows) << 7);
}
inline uint64_t NextAlongY(uint64_t own, uint64_t beyond) {
  return own >> 8 | (beyond & kFirstRow) << 56;
}

// Over the four corners of cells in one layer, of a block and those behind it.
inline uint64_t AllOfFour(uint64_t own, uint64_t x, uint64_t y, uint64_t xy) {
  const uint64_t pairs = own & NextAlongX(own, x), beyond = y & NextAlongX(y, xy);
  return pairs & NextAlongY(pairs, beyond);
}
inline uint64_t AnyOfFour(uint64_t own, uint64_t x, uint64_t y, uint64_t xy) {
  const uint64_t pairs = own | NextAlongX(own, x), beyond = y | NextAlongX(y, xy);
  return pairs | NextAlongY(pairs, beyond);
}

VISMAP_VECTOR_CLONES void MarkCells(const uint64_t* observed, const uint64_t* behind,
                                    uint64_t* __restrict cells) {
  constexpr int kLayers = kBlockSide + 1;
  uint64_t seen[kLayers], any[kLayers], all[kLayers];
  for (int z = 0; z < kLayers; ++z) {
    seen[z] = AllOfFour(observed[z], observed[kLayers + z], observed[2 * kLayers + z],
                        observed[3 * kLayers + z]);
    any[z] =
        AnyOfFour(behind[z], behind[kLayers + z], behind[2 * kLayers + z], behind[3 * kLayers + z]);
    all[z] =
        AllOfFour(behind[z], behind[kLayers + z], behind[2 * kLayers + z], behind[3 * kLayers + z]);
  }
  for (int z = 0; z < kBlockSide; ++z)
    cells[z] = seen[z] & seen[z + 1] & (any[z] | any[z + 1]) & ~(all[z] & all[z + 1]);
}

// A row of a block. As a vector of its own: loops over few rows are not vectorised else.
using Row = int16_t __attribute__((vector_size(sizeof(int16_t) * kBlockSide)));

constexpr Row kRowBits = {1, 2, 4, 8, 16, 32, 64, 128};
constexpr int16_t kU = kUnseenDistance;
constexpr Row kUnseenRow = {kU, kU, kU, kU, kU, kU, kU, kU};

// The voxels of a row whose bit is set; the others unseen.
inline Row SeenOfRow(const int16_t* distances, uint64_t bits) {
  const auto all = static_cast<int16_t>(bits & 0xFF);
  const Row is_seen = Row{all, all, all, all, all, all, all, all} & kRowBits;
  Row row;
  std::memcpy(&row, distances, sizeof(row));
  return is_seen != 0 ? row : kUnseenRow;
}

// A layer of three blocks along x. As values: what is stored might else be one of them.
struct Layers {
  const int16_t *lower, *own, *upper;
  uint64_t lower_seen, own_seen, upper_seen;
};
inline Layers LayersOf(const SeenBlock* blocks, int z) {
  const int first = LinearIndex(0, 0, z);
  return {blocks[0].distances + first, blocks[1].distances + first, blocks[2].distances + first,
          blocks[0].observed[z],       blocks[1].observed[z],       blocks[2].observed[z]};
}

// Copies a row of the grid: one voxel of the first block, all of the second, two of the third; with
// six unseen ones behind these, the last of them at the beginning of the next row.
inline void CopyRow(const Layers& layers, int y, int16_t* grid) {
  constexpr int kLast = kBlockSide - 1;
  const int row = kBlockSide * y;
  const int16_t lower = layers.lower[row + kLast];
  grid[0] = (layers.lower_seen >> (row + kLast) & 1) != 0 ? lower : kUnseenDistance;
  const Row own = SeenOfRow(layers.own + row, layers.own_seen >> row);
  std::memcpy(grid + 1, &own, sizeof(own));
  const Row upper = SeenOfRow(layers.upper + row, layers.upper_seen >> row & 3);
  std::memcpy(grid + 1 + kBlockSide, &upper, sizeof(upper));
}

VISMAP_VECTOR_CLONES void CopyLayers(const SeenBlock* blocks, int from, int to, int16_t* grid) {
  for (int z = from; z < to; ++z, grid += kGridLayer) {
    CopyRow(LayersOf(blocks, z), kBlockSide - 1, grid);
    const Layers middle = LayersOf(blocks + 3, z);
    for (int y = 0; y < kBlockSide; ++y) CopyRow(middle, y, grid + (y + 1) * kGridRow);
    const Layers last = LayersOf(blocks + 6, z);
    for (int y = 0; y < 2; ++y) CopyRow(last, y, grid + (y + 1 + kBlockSide) * kGridRow);
  }
}

constexpr float kUnseen = kUnseenDistance;

// Central difference in steps per voxel; one-sided at the rim of what was seen.
inline float Slope(float here, float low, float high) {
  const float below = low > kUnseen ? low : here;
  const float above = high > kUnseen ? high : here;
  const float half = low > kUnseen ? 0.5F : 1.0F;
  const float factor = high > kUnseen ? half : 1.0F;
  return (above - below) * factor;
}

constexpr int kN = kVertexLanes;
constexpr int kGroup = kVertexGroup;
constexpr uint16_t kSlotMask = kSlotStride - 1;

inline int CoordinateOf(uint16_t slot, int axis) { return slot >> (kSlotBits * axis) & kSlotMask; }
inline int AxisOf(uint16_t slot) { return slot >> (3 * kSlotBits); }

inline uint32_t EndAt(uint32_t slot) {
  // Of each coordinate's four bits the highest tells the block.
  const uint32_t block = (slot >> 3 & 1) | (slot >> 6 & 2) | (slot >> 9 & 4);
  const uint32_t offset = (slot & 0x7) | (slot >> 1 & 0x38) | (slot >> 2 & 0x1C0);
  return offset | block << kEndBits;
}

VISMAP_VECTOR_CLONES void Locate(const uint16_t* slots, int groups, uint32_t* __restrict lower_out,
                                 uint32_t* __restrict upper_out) {
  for (int group = 0; group < groups * kGroup; group += kGroup) {
    for (int i = group; i < group + kGroup; ++i) {
      const uint32_t slot = slots[i];
      const uint32_t across = slot < 2 * kAxisSlots ? kSlotStride : kSlotStride * kSlotStride;
      const uint32_t step = slot < kAxisSlots ? 1 : across;
      lower_out[i] = EndAt(slot);
      upper_out[i] = EndAt(slot + step);
    }
  }
}

VISMAP_VECTOR_CLONES void PickNearer(const uint32_t* lower, const uint32_t* upper, const float* t,
                                     int groups, uint32_t* __restrict nearer_out) {
  for (int group = 0; group < groups * kGroup; group += kGroup) {
    for (int i = group; i < group + kGroup; ++i) {
      // Both are read in any case: of one or the other GCC 12 makes wrong code for AVX2.
      const uint32_t low = lower[i], high = upper[i];
      nearer_out[i] = t[i] > 0.5F ? high : low;
    }
  }
}

VISMAP_VECTOR_CLONES void Cut(const uint16_t* slots, const int16_t* a, const int16_t* b, int groups,
                              float* __restrict t_out, float* __restrict normal_out) {
  for (int group = 0; group < groups * kGroup; group += kGroup) {
    for (int i = group; i < group + kGroup; ++i) {
      const auto low = [i](const int16_t* star, int along) {
        return static_cast<float>(star[(2 * along + 1) * kN + i]);
      };
      const auto high = [i](const int16_t* star, int along) {
        return static_cast<float>(star[(2 * along + 2) * kN + i]);
      };
      const float from = a[i], to = b[i];
      const float exact = from / (from - to);
      const float at_least = exact < 0.01F ? 0.01F : exact;
      const float t = at_least > 0.99F ? 0.99F : at_least;
      const float x =
          Slope(from, low(a, 0), high(a, 0)) * (1 - t) + Slope(to, low(b, 0), high(b, 0)) * t;
      const float y =
          Slope(from, low(a, 1), high(a, 1)) * (1 - t) + Slope(to, low(b, 1), high(b, 1)) * t;
      const float z =
          Slope(from, low(a, 2), high(a, 2)) * (1 - t) + Slope(to, low(b, 2), high(b, 2)) * t;
      const float length = std::sqrt(x * x + (y * y + z * z));
      // No slope to speak of: toward the end that lies in front of the surface.
      const float sign = from < 0 ? 1.0F : -1.0F;
      const int axis = AxisOf(slots[i]);
      const float along_x = axis == 0 ? sign : sign * 0.0F;
      const float along_y = axis == 1 ? sign : sign * 0.0F;
      const float along_z = axis == 2 ? sign : sign * 0.0F;
      t_out[i] = t;
      normal_out[i] = length > 1 ? x / length : along_x;
      normal_out[kN + i] = length > 1 ? y / length : along_y;
      normal_out[2 * kN + i] = length > 1 ? z / length : along_z;
    }
  }
}

VISMAP_VECTOR_CLONES void Position(const uint16_t* slots, const float* t, int axis, int groups,
                                   double first, double step, float* __restrict position_out) {
  for (int group = 0; group < groups * kGroup; group += kGroup) {
    for (int i = group; i < group + kGroup; ++i) {
      const double along = AxisOf(slots[i]) == axis ? t[i] : 0.0F;
      const double center = first + static_cast<double>(CoordinateOf(slots[i], axis));
      position_out[i] = static_cast<float>((center + along) * step);
    }
  }
}

VISMAP_VECTOR_CLONES void Blend(const uint32_t* lower, const uint32_t* upper, const float* t,
                                int groups, uint32_t* __restrict color_out) {
  constexpr uint32_t kOne = 256, kOuter = 0xFF00FF, kMiddle = 0xFF00;
  constexpr uint32_t kHalves = (kOne / 2) | (kOne / 2) << 16;
  for (int group = 0; group < groups * kGroup; group += kGroup) {
    for (int i = group; i < group + kGroup; ++i) {
      const auto share = static_cast<uint32_t>(static_cast<int>(t[i] * float{kOne} + 0.5F));
      const auto mix = [share](uint32_t low, uint32_t high) {  // up to two bytes, 16 bits apart
        return low * (kOne - share) + high * share + kHalves;
      };
      const uint32_t outer = mix(lower[i] & kOuter, upper[i] & kOuter) >> 8 & kOuter;
      color_out[i] = outer | (mix(lower[i] >> 8 & 0xFF, upper[i] >> 8 & 0xFF) & kMiddle);
    }
  }
}

// Widens what belongs to a cell to the cell's two corners along x.
inline uint16_t Wide(uint16_t cells) { return static_cast<uint16_t>(cells | cells << 1); }

VISMAP_VECTOR_CLONES void Cross(const uint16_t* behind, const uint16_t* cells, int rows,
                                uint16_t* __restrict x_out, uint16_t* __restrict y_out,
                                uint16_t* __restrict z_out) {
  constexpr int kLayer = kBitRows;
  for (int i = 0; i < rows; ++i) {
    const uint16_t own = cells[i], before = cells[i - 1];
    const uint16_t below = cells[i - kLayer], below_before = cells[i - kLayer - 1];
    const uint16_t corners = behind[i];
    const uint16_t along_x = corners ^ corners >> 1;
    const uint16_t along_y = corners ^ behind[i + 1];
    const uint16_t along_z = corners ^ behind[i + kLayer];
    x_out[i] = along_x & (own | before | below | below_before);
    y_out[i] = along_y & Wide(own | below);
    z_out[i] = along_z & Wide(own | before);
  }
}

VISMAP_VECTOR_CLONES void Spread(const uint8_t* bytes, const uint8_t* beyond,
                                 uint16_t* __restrict rows_out) {
  for (int i = 0; i < kBlockSide; ++i) {
    const uint16_t row = bytes[i], next = beyond[i] & 1;
    rows_out[i] = static_cast<uint16_t>(row | next << kBlockSide);
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
  FlagVoxels(voxels.distance.data(), voxels.weight.data(), gate.weight, observed, behind);
  // What has a weight was seen at least once.
  if (gate.observations > 1)
    UnflagRare(voxels.observations.data(), gate.observations, observed, behind);
  PackSigns(observed, signs.observed);
  PackSigns(behind, signs.behind);
}

void MarkSurfaceCells(const LatticeBits& observed, const LatticeBits& behind, CellBits& cells) {
  MarkCells(observed.front().data(), behind.front().data(), cells.data());
}

void CopySeen(const SeenBlocks& blocks, int from, int to, int layer, DistanceGrid& grid) {
  CopyLayers(blocks.data(), from, to, grid.data() + GridOffset(kGridLow, kGridLow, layer));
}

void LocateEnds(size_t groups, VertexLanes& vertices) {
  Locate(vertices.slot.data(), static_cast<int>(groups), vertices.lower_end.data(),
         vertices.upper_end.data());
}

void PlaceVertices(size_t groups, const VoxelCenters& centers, VertexLanes& vertices) {
  const auto n = static_cast<int>(groups);
  const uint16_t* slots = vertices.slot.data();
  float* t = vertices.t.data();
  Cut(slots, vertices.lower.front().data(), vertices.upper.front().data(), n, t,
      vertices.normal.front().data());
  PickNearer(vertices.lower_end.data(), vertices.upper_end.data(), t, n,
             vertices.nearer_end.data());
  for (size_t axis = 0; axis < 3; ++axis) {
    Position(slots, t, static_cast<int>(axis), n, centers.first[axis], centers.step,
             vertices.position[axis].data());
  }
}

void BlendColors(size_t groups, VertexLanes& vertices) {
  Blend(vertices.lower_color.data(), vertices.upper_color.data(), vertices.t.data(),
        static_cast<int>(groups), vertices.color.data());
}

void CrossEdges(const uint16_t* behind, const uint16_t* cells, int rows, const EdgeRows& out) {
  Cross(behind, cells, rows, out.x, out.y, out.z);
}

void SpreadRows(uint64_t bytes, uint64_t beyond, uint16_t* rows_out) {
  uint8_t own[kBlockSide], next[kBlockSide];
  std::memcpy(own, &bytes, sizeof(own));
  std::memcpy(next, &beyond, sizeof(next));
  Spread(own, next, rows_out);
}

}  // namespace vismap
