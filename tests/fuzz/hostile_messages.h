#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "support/mutations.h"

namespace vismap {

/// One message type on its way into a process: a good message, and the code that the process runs
/// on it.
struct FuzzTarget {
  std::string type;            ///< for example "rgbd_frame_t"
  size_t channel_bytes = 0;    ///< largest message that its channel takes
  std::vector<uint8_t> good;   ///< a message as it travels
  size_t checksum_offset = 0;  ///< in `good`; 0 = the type has none
  /// Unpack and Decode to the values that processes work with; what it returns says whether the
  /// message was taken.
  std::function<Result<void>(std::span<const uint8_t>)> decode;
  /// The good message again, with something changed inside its compressed parts, which checksums
  /// would else protect. Absent for types without such parts.
  std::function<std::vector<uint8_t>(TestRandom*)> spoil_inside;
  /// Most memory that decoding may take: what the largest image or map part needs that a compressed
  /// part may hold [bytes], and so much per byte of the message for all else: message and values
  /// beside each other, elements as wide as their C++ types.
  size_t largest_content = 0;
  size_t peak_content = 0;
  size_t AllowedPeak(size_t message_bytes) const {
    return peak_content + 64 * 1024 + 24 * message_bytes;
  }
  size_t AllowedAllocation(size_t message_bytes) const {
    return largest_content + 64 * 1024 + 8 * message_bytes;
  }
};

/// One of every type that travels on the bus.
std::vector<FuzzTarget> AllFuzzTargets();

/// A message with a few bytes, or a length, changed, cut, or a piece put in twice; or spoilt
/// inside.
std::vector<uint8_t> Mutate(const FuzzTarget& target, TestRandom* random);

/// `bytes` with the checksum taken away, as an attacker would do it.
void DropChecksum(const FuzzTarget& target, std::vector<uint8_t>* bytes);

/// Numbers that overflow, wrap, or lie just beyond what is there.
inline constexpr int64_t kHostileLengths[] = {
    -1,         -2147483648, 2147483647, 0x40000001, 0x20000001, 0x10000001, 0x7fffffff / 24,
    0x00ffffff, 1 << 20,     65536,      4096,       1,          0};

void WriteLength(int64_t length, size_t at, std::vector<uint8_t>* bytes);

}  // namespace vismap
