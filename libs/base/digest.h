#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace vismap {

/// Streaming 128-bit content hash (XXH3). Two maps are called equal when their digests are. Not
/// cryptographic.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void AddBytes(const void* data, size_t size);

  /// Adds the object representation of a value without padding (integers, enums, floats).
  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void Add(T value) { AddBytes(&value, sizeof(value)); }

  /// 32 lower-case hexadecimal digits of everything added so far.
  std::string Hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 64-bit XXH3 of a byte range; the checksum of bulk messages and map files.
uint64_t Checksum64(std::span<const uint8_t> bytes);

}  // namespace vismap
