#pragma once

#include <cstddef>

namespace vismap {

/// Asks memory for the cache line at an address, which may be any.
inline void PrefetchLine(const void* address) {
  __builtin_prefetch(address);
  // GCC takes a function that does nothing else for one without effect and drops the calls of it.
  asm volatile("");
}

/// Asks memory for all lines of an array.
template <typename Array>
void PrefetchAll(const Array& array) {
  constexpr size_t kLine = 64;
  const auto* bytes = reinterpret_cast<const std::byte*>(array.data());
  for (size_t i = 0; i < sizeof(array); i += kLine) PrefetchLine(bytes + i);
}

}  // namespace vismap
