#include "navigation/distance_kernels.h"

#include <algorithm>

#include "geometry/vector_clones.h"

namespace vismap {
namespace {

constexpr int kLanes = 64;
constexpr int kStepsPerCheck = 4;  // after so many steps, it is looked whether more can matter

}  // namespace

VISMAP_VECTOR_CLONES
void LeastAlongLine(const uint16_t* in, ptrdiff_t stride, int window, const uint16_t* cost,
                    uint16_t most, uint16_t* out) {
  uint16_t least[kLanes];
  for (int i = 0; i < kLanes; ++i) least[i] = in[i];
  for (int d = 1; d <= window;) {
    uint16_t largest = 0;
    for (int i = 0; i < kLanes; ++i) largest = std::max(largest, least[i]);
    if (largest <= cost[d]) break;
    for (const int end = std::min(window + 1, d + kStepsPerCheck); d < end; ++d) {
      const uint16_t* before = in - d * stride;
      const uint16_t* behind = in + d * stride;
      const uint16_t add = cost[d];
      for (int i = 0; i < kLanes; ++i) {
        const uint16_t nearer = std::min(before[i], behind[i]);
        least[i] = std::min(least[i], static_cast<uint16_t>(nearer + add));
      }
    }
  }
  for (int i = 0; i < kLanes; ++i) out[i] = least[i] > most ? kBeyond : least[i];
}

VISMAP_VECTOR_CLONES
void SquareRowDistances(const uint8_t* leaves, uint16_t* squared) {
  for (int i = 0; i < kLanes; ++i) {
    const uint16_t d = leaves[i];
    const auto half_leaves = static_cast<uint16_t>(2 * d - (d > 0));
    const auto square = static_cast<uint16_t>(half_leaves * half_leaves);
    squared[i] = d == kNoneInRow ? kBeyond : square;
  }
}

VISMAP_VECTOR_CLONES
uint16_t Largest(const uint16_t* values) {
  uint16_t largest = 0;
  for (int i = 0; i < kLanes; ++i) largest = std::max(largest, values[i]);
  return largest;
}

VISMAP_VECTOR_CLONES
bool AnyNear(const uint16_t* least, const uint16_t* cost, const uint16_t* now, uint16_t most) {
  uint16_t any = 0;
  for (int i = 0; i < kLanes; ++i) {
    const auto reached = static_cast<uint16_t>(least[i] + cost[i]);
    any |= static_cast<uint16_t>(reached <= std::min(now[i], most));
  }
  return any != 0;
}

}  // namespace vismap
