#pragma once

#include <cstddef>
#include <cstdint>

namespace vismap {

// The loops of distance fields over leaves. They have no branches for single leaves, so that they
// are vectorised, and are compiled once per SIMD level with equal results. Distances are squared,
// in half leaves, see SiteField.
//
// Twins, plain code for one leaf: tests/navigation/naive_distances.h. The tests
// DistanceKernels.* in tests/navigation/distance_kernels_test.cc hold the two equal.

/// No site within the largest distance. Sums of two distances fit 16 bits.
inline constexpr uint16_t kBeyond = 32767;
/// The largest distance of a field [half leaves]; its square is below kBeyond.
inline constexpr int kMostHalfLeaves = 180;
/// In a row: no site within the largest distance [leaves].
inline constexpr uint8_t kNoneInRow = 255;

/// 64 leaves: out[i] = min over |d| <= window of in[i + d stride] + cost[|d|], kBeyond when that
/// is more than `most`. `in` is readable `window` strides to both sides; cost[0] = 0, ascending.
/// Twin: NaiveLeast.
void LeastAlongLine(const uint16_t* in, ptrdiff_t stride, int window, const uint16_t* cost,
                    uint16_t most, uint16_t* out);

/// 64 leaves: distance to a site of the same row [leaves], kNoneInRow = none, to the squared
/// distance to its face: (2 d - 1)^2, 0 for d = 0, kBeyond for none. Twin: NaiveSquare.
void SquareRowDistances(const uint8_t* leaves, uint16_t* squared);

/// The largest of 64 values.
uint16_t Largest(const uint16_t* values);

/// 64 leaves: whether least[i] + cost[i] <= min(now[i], most) for any of them. Twin: NaiveAnyNear.
bool AnyNear(const uint16_t* least, const uint16_t* cost, const uint16_t* now, uint16_t most);

}  // namespace vismap
