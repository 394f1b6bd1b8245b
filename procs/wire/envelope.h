#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/digest.h"
#include "base/require.h"
#include "base/result.h"

namespace vismap {

/// Messages that carry a checksum: the bulky ones.
template <typename Message>
concept Checksummed = requires(Message message) {
  message.checksum;
};

namespace envelope {

/// Bytes of an encoded message before its checksum field: fingerprint, utime, seq, source.
inline size_t ChecksumOffset(const std::string& source) {
  return 8 + 8 + 8 + 4 + source.size() + 1;
}

/// XXH3-64 of all that follows the checksum field; never 0, which stands for "not computed".
int64_t ChecksumAfter(std::span<const uint8_t> bytes, size_t checksum_offset);
void WriteBigEndian(int64_t value, uint8_t* destination);
std::string FingerprintError(std::span<const uint8_t> bytes, const char* type, int64_t expected);

}  // namespace envelope

/// What every message begins with.
struct MessageHead {
  int64_t fingerprint = 0;  ///< of its type
  int64_t utime = 0;        ///< [us]
  int64_t seq = 0;          ///< 0, 1, ... per source and channel
  std::string source;       ///< the process that published it
};

/// Reads the head of an encoded message without looking at the rest; none when it is cut short.
std::optional<MessageHead> PeekHead(std::span<const uint8_t> bytes);

/// The bytes of a message as they travel, with its checksum computed and filled in where the type
/// has one. Throws when an array of the message has not the length that its size field states, a
/// bug of ours.
template <typename Message>
std::vector<uint8_t> Pack(Message& message) {
  std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  Require(written == static_cast<int>(bytes.size()), "message encodes to the size it states");
  if constexpr (Checksummed<Message>) {
    const size_t offset = envelope::ChecksumOffset(message.source);
    message.checksum = envelope::ChecksumAfter(bytes, offset);
    envelope::WriteBigEndian(message.checksum, bytes.data() + offset);
  }
  return bytes;
}

/// The message in `bytes`. Fails on another type (or version of it), on more than `max_bytes`, on
/// lengths that do not fit, on trailing bytes, and on a checksum that does not match. Never throws.
template <typename Message>
Result<Message> Unpack(std::span<const uint8_t> bytes, size_t max_bytes) {
  const std::string type = Message::getTypeName();
  if (bytes.size() > max_bytes) {
    return Fail(type + ": " + std::to_string(bytes.size()) + " bytes, at most " +
                std::to_string(max_bytes) + " are allowed");
  }
  Message message{};
  const int read = message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  if (read < 0)
    return Fail(envelope::FingerprintError(bytes, Message::getTypeName(), Message::getHash()));
  if (read != static_cast<int>(bytes.size())) {
    return Fail(type + ": " + std::to_string(bytes.size()) + " bytes, its fields end after " +
                std::to_string(read));
  }
  if constexpr (Checksummed<Message>) {
    const size_t offset = envelope::ChecksumOffset(message.source);
    if (message.checksum != 0 && message.checksum != envelope::ChecksumAfter(bytes, offset)) {
      return Fail(type +
                  ": checksum does not match the content, the message was damaged on its way");
    }
  }
  return message;
}

}  // namespace vismap
