#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/digest.h"
#include "base/raw_bytes.h"
#include "base/require.h"
#include "base/result.h"
#include "wire/older_types.h"

namespace vismap {

/// A message type with a checksum field; the types that carry images, meshes and other large data
/// have one.
template <typename Message>
concept Checksummed = requires(Message message) {
  message.checksum;
};

namespace envelope {

/// Offset of the checksum field in an encoded message [bytes]. Before it stand fingerprint, utime,
/// seq and source.
inline size_t ChecksumOffset(const std::string& source) {
  return 8 + 8 + 8 + 4 + source.size() + 1;
}

/// XXH3-64 of all bytes after the checksum field. Never 0, since 0 means "not computed".
int64_t ChecksumAfter(std::span<const uint8_t> bytes, size_t checksum_offset);
void WriteBigEndian(int64_t value, uint8_t* destination);
/// The first eight bytes of a message.
int64_t ReadFingerprint(std::span<const uint8_t> bytes);
/// The sentence for bytes that LCM cannot decode as `type`: wrong fingerprint, or too short.
std::string FingerprintError(std::span<const uint8_t> bytes, const char* type, int64_t expected);

}  // namespace envelope

/// The fields with which every message begins.
struct MessageHead {
  int64_t fingerprint = 0;  ///< of the message type; of the current version for a message of an
                            ///< older one
  int64_t utime = 0;        ///< [us]
  int64_t seq = 0;          ///< counts 0, 1, ... per source and channel
  std::string source;       ///< name of the process that published the message
};

/// Reads the head of an encoded message without decoding the rest; nullopt when the bytes are too
/// short, or the source is no valid string or has more than 255 characters.
std::optional<MessageHead> PeekHead(std::span<const uint8_t> bytes);

/// Encodes a message for the bus. Computes the checksum and stores it in the message where the type
/// has one. Throws when an array does not have the length that its size field states, which is a
/// programming error.
template <typename Message>
RawBytes PackRaw(Message& message) {
  RawBytes bytes(static_cast<size_t>(message.getEncodedSize()));
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  Require(written == static_cast<int>(bytes.size()), "message encodes to the size it states");
  if constexpr (Checksummed<Message>) {
    const size_t offset = envelope::ChecksumOffset(message.source);
    message.checksum = envelope::ChecksumAfter(bytes, offset);
    envelope::WriteBigEndian(message.checksum, bytes.data() + offset);
  }
  return bytes;
}

/// The same in a usual vector.
template <typename Message>
std::vector<uint8_t> Pack(Message& message) {
  const RawBytes bytes = PackRaw(message);
  return {bytes.begin(), bytes.end()};
}

namespace envelope {

/// Decodes a message of this version of its type. Fails as Unpack does.
template <typename Message>
Result<Message> UnpackExactly(std::span<const uint8_t> bytes, size_t max_bytes) {
  const std::string type = Message::getTypeName();
  if (bytes.size() > max_bytes) {
    return Fail(type + ": " + std::to_string(bytes.size()) + " bytes are more than the allowed " +
                std::to_string(max_bytes));
  }
  Message message{};
  const int read = message.decode(bytes.data(), 0, static_cast<int>(bytes.size()));
  if (read < 0)
    return Fail(envelope::FingerprintError(bytes, Message::getTypeName(), Message::getHash()));
  if (read != static_cast<int>(bytes.size())) {
    return Fail(type + ": " + std::to_string(bytes.size()) +
                " bytes, but its fields end after byte " + std::to_string(read));
  }
  if constexpr (Checksummed<Message>) {
    const size_t offset = envelope::ChecksumOffset(message.source);
    if (message.checksum != 0 && message.checksum != envelope::ChecksumAfter(bytes, offset)) {
      return Fail(type +
                  ": the checksum does not match the content; the message was damaged in transit");
    }
  }
  return message;
}

}  // namespace envelope

/// Decodes a message, also one of an older version of the type. Fails on a different type, on more
/// than `max_bytes`, on impossible array lengths, on trailing bytes, and on a checksum that does
/// not match. Never throws.
template <typename Message>
Result<Message> Unpack(std::span<const uint8_t> bytes, size_t max_bytes) {
  const auto converted = ConvertOlderMessage(bytes, max_bytes);
  if (!converted) return envelope::UnpackExactly<Message>(bytes, max_bytes);
  if (!*converted) return tl::unexpected(converted->error());
  return envelope::UnpackExactly<Message>(**converted, (*converted)->size());
}

}  // namespace vismap
