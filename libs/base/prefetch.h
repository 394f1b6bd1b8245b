#pragma once

#include <cstddef>

namespace vismap {

/// Prefetches the cache line of an address. Any address is allowed.
inline void PrefetchLine(const void* address) {
  __builtin_prefetch(address);
  // Without this, GCC takes the function for one without effect and drops its calls.
  asm volatile("");
}

/// Prefetches all cache lines of an array.
template <typename Array>
void PrefetchAll(const Array& array) {
  constexpr size_t kLine = 64;
  const auto* bytes = reinterpret_cast<const std::byte*>(array.data());
  for (size_t i = 0; i < sizeof(array); i += kLine) PrefetchLine(bytes + i);
}

}  // namespace vismap
