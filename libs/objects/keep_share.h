#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace vismap {

/// Keeps about this share [0, 1] of the elements, evenly spread and always with the first one. The
/// choice follows the golden ratio, so it has no period that could match the rows of a point grid.
template <typename T>
void KeepShare(double share, std::vector<T>* elements) {
  constexpr uint32_t kGoldenRatio = 0x9E3779B9;  // its fraction, in steps of 2^-32
  size_t kept = 0;
  for (size_t i = 0; i < elements->size(); ++i) {
    const uint32_t place = static_cast<uint32_t>(i) * kGoldenRatio;
    if (place <= share * 4294967295.0) (*elements)[kept++] = std::move((*elements)[i]);
  }
  elements->resize(kept);
}

}  // namespace vismap
