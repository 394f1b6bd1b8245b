#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

/// Bounds that scripts/cmake/GuardLcmTypes.cmake writes into the code of lcm-gen 1.3.1, which
/// trusts every length it decodes: without them a message of 120 bytes can crash its reader or make
/// it allocate gigabytes.
namespace vismap_lcm_guard {

/// The fewest bytes that one element of type T can take in an encoded message.
template <typename T>
int MinEncodedSize() {
  if constexpr (std::is_same_v<T, std::string>) {
    return 5;  // length and terminator
  } else if constexpr (std::is_arithmetic_v<T>) {
    return static_cast<int>(sizeof(T));
  } else {
    static const int size = T{}._getEncodedSizeNoHash();  // all arrays empty
    return size < 1 ? 1 : size;
  }
}

/// Whether `count` elements of a vector of type `Vector` can stand in the `left` bytes of the
/// message.
template <typename Vector>
bool Fits(int64_t count, int left) {
  return count >= 0 && count <= left / MinEncodedSize<typename Vector::value_type>();
}

/// Whether a string of `length` bytes, terminator included, stands at `text` within `left` bytes:
/// it must end with its only NUL.
inline bool IsString(const void* text, int32_t length, int left) {
  return length >= 1 && length <= left &&
         std::memchr(text, 0, static_cast<size_t>(length)) ==
             static_cast<const char*>(text) + length - 1;
}

}  // namespace vismap_lcm_guard
