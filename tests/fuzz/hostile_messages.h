#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "support/mutations.h"

namespace vismap {

/// One message type: a valid message, and the code that processes run on a received message.
struct FuzzTarget {
  std::string type;            ///< for example "rgbd_frame_t"
  size_t channel_bytes = 0;    ///< largest message of its channel [bytes]
  std::vector<uint8_t> good;   ///< an encoded valid message
  size_t checksum_offset = 0;  ///< of the checksum in `good`; 0 = the type has none
  /// Unpacks and decodes a message as processes do; returns whether it was accepted.
  std::function<Result<void>(std::span<const uint8_t>)> decode;
  /// The valid message with a change inside its compressed parts, which checksums would otherwise
  /// protect. Empty for types without such parts.
  std::function<std::vector<uint8_t>(TestRandom*)> spoil_inside;
  /// Limit for the memory of decoding: the size of the largest image or map part that a compressed
  /// part may contain [bytes], plus a number of bytes per byte of the message for everything else,
  /// namely for the message and the decoded values, in which elements have the size of their C++
  /// types.
  size_t largest_content = 0;
  size_t peak_content = 0;
  size_t AllowedPeak(size_t message_bytes) const {
    return peak_content + 64 * 1024 + 24 * message_bytes;
  }
  size_t AllowedAllocation(size_t message_bytes) const {
    return largest_content + 64 * 1024 + 8 * message_bytes;
  }
};

/// One target for every message type of the bus, and for every kind of message of other robots'
/// programs that the adapter reads.
std::vector<FuzzTarget> AllFuzzTargets();

/// A mutated message: with changed bytes or lengths, truncated, with a part inserted twice, or
/// changed inside its compressed parts.
std::vector<uint8_t> Mutate(const FuzzTarget& target, TestRandom* random);

/// `bytes` with the checksum set to 0, as an attacker would do.
void DropChecksum(const FuzzTarget& target, std::vector<uint8_t>* bytes);

/// Lengths that overflow, wrap around, or are slightly too large.
inline constexpr int64_t kHostileLengths[] = {
    -1,         -2147483648, 2147483647, 0x40000001, 0x20000001, 0x10000001, 0x7fffffff / 24,
    0x00ffffff, 1 << 20,     65536,      4096,       1,          0};

void WriteLength(int64_t length, size_t at, std::vector<uint8_t>* bytes);

}  // namespace vismap
