#pragma once

namespace vismap {

/// Asks memory for the cache line at an address, which may be any.
inline void PrefetchLine(const void* address) {
  __builtin_prefetch(address);
  // GCC takes a function that does nothing else for one without effect and drops the calls of it.
  asm volatile("");
}

}  // namespace vismap
