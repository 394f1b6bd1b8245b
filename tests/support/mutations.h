#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// Small seeded generator (splitmix64), the same on every machine.
class TestRandom {
 public:
  explicit TestRandom(uint64_t seed) : state_(seed) {}

  uint64_t Next() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, count).
  uint64_t Below(uint64_t count) { return Next() % count; }
  /// In [0, 1).
  double Unit() { return static_cast<double>(Next() >> 11) * 0x1p-53; }

 private:
  uint64_t state_;
};

/// Calls `decode(bytes)` with hostile variants of `good`: every truncation (at most about 500 of
/// them, evenly spread, always with the last 16), and `flips` copies with 1 to 4 changed bytes.
/// `decode` must return, and the sanitizers check its use of memory.
template <typename Decode>
void ForEachMutation(std::span<const uint8_t> good, int flips, const Decode& decode) {
  const size_t step = 1 + good.size() / 500;
  for (size_t size = 0; size < good.size(); size += size + 16 < good.size() ? step : 1) {
    decode(std::vector<uint8_t>(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  TestRandom random(7);
  for (int i = 0; i < flips && !good.empty(); ++i) {
    std::vector<uint8_t> bad(good.begin(), good.end());
    for (uint64_t n = 1 + random.Below(4); n > 0; --n) {
      bad[random.Below(bad.size())] = static_cast<uint8_t>(random.Next());
    }
    decode(bad);
  }
}

}  // namespace vismap
