#pragma once

#include <cstddef>
#include <cstdint>

namespace vismap {

/// 64 pseudo-random bits of a number (splitmix64). Random numbers are made from keys such as (seed,
/// frame, pixel), so that they do not depend on the order of calls or the number of threads.
inline uint64_t Mix(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

inline uint64_t Mix(uint64_t a, uint64_t b) { return Mix(Mix(a) ^ b); }

/// Uniform in [0, 1).
inline double Uniform(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Nearly normally distributed, with mean 0 and standard deviation 1, within +-6: the sum of 12
/// uniform numbers minus 6. Needs no logarithm, whose last bits differ between C libraries.
inline double Normal(uint64_t key) {
  uint64_t sum = 0;
  for (int i = 0; i < 3; ++i) {
    uint64_t bits = Mix(key + static_cast<uint64_t>(i) * 0xd1b54a32d192ed03u);
    for (int k = 0; k < 4; ++k, bits >>= 16) sum += bits & 0xffff;
  }
  return (static_cast<double>(sum) + 6) / 65536.0 - 6;
}

/// A sequence of random numbers that depends on its key alone.
class Dice {
 public:
  explicit Dice(uint64_t key) : key_(key) {}

  double Between(double low, double high) {
    return low + (high - low) * Uniform(Mix(key_, ++drawn_));
  }
  bool Chance(double probability) { return Between(0, 1) < probability; }
  /// Uniform in 0..count-1.
  size_t Of(size_t count) { return Mix(key_, ++drawn_) % count; }

 private:
  uint64_t key_;
  uint64_t drawn_ = 0;
};

}  // namespace vismap
