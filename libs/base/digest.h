#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace vismap {

/// Hash of a stream of values, 128 bits (XXH3), not cryptographic. Maps with equal digests count as
/// equal.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void AddBytes(const void* data, size_t size);

  /// Adds the bytes of a value as they are in memory.
  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void Add(T value) { AddBytes(&value, sizeof(value)); }

  /// The digest of everything added so far: 32 lower-case hexadecimal digits.
  std::string Hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// XXH3 of bytes, 64 bits: the checksum of large messages and map files.
uint64_t Checksum64(std::span<const uint8_t> bytes);

}  // namespace vismap
