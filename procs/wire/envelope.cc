#include "wire/envelope.h"

#include <algorithm>
#include <cstdio>

#include "lcm_guard.h"

namespace vismap {
namespace {

// Processes keep the names of sources, so they are bounded [bytes].
constexpr int32_t kMaxSourceBytes = 256;

uint64_t ReadBigEndian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : bytes) value = (value << 8) | byte;
  return value;
}

}  // namespace

std::optional<MessageHead> PeekHead(std::span<const uint8_t> bytes) {
  constexpr size_t kFixed = 28;  // fingerprint, utime, seq, length of source
  if (bytes.size() < kFixed) return std::nullopt;
  const auto length = static_cast<int32_t>(ReadBigEndian(bytes.subspan(24, 4)));
  const std::span<const uint8_t> rest = bytes.subspan(kFixed);
  if (length > kMaxSourceBytes ||
      !vismap_lcm_guard::IsString(rest.data(), length, static_cast<int>(rest.size())))
    return std::nullopt;
  const int64_t fingerprint = envelope::ReadFingerprint(bytes);
  const OlderType* older = FindOlderType(fingerprint);
  return MessageHead{
      older != nullptr ? older->current : fingerprint,
      static_cast<int64_t>(ReadBigEndian(bytes.subspan(8, 8))),
      static_cast<int64_t>(ReadBigEndian(bytes.subspan(16, 8))),
      std::string(reinterpret_cast<const char*>(rest.data()), static_cast<size_t>(length) - 1)};
}

namespace envelope {

int64_t ChecksumAfter(std::span<const uint8_t> bytes, size_t checksum_offset) {
  const auto sum = static_cast<int64_t>(Checksum64(bytes.subspan(checksum_offset + 8)));
  return sum == 0 ? 1 : sum;
}

void WriteBigEndian(int64_t value, uint8_t* destination) {
  const auto bits = static_cast<uint64_t>(value);
  for (int i = 0; i < 8; ++i) destination[i] = static_cast<uint8_t>(bits >> (8 * (7 - i)));
}

int64_t ReadFingerprint(std::span<const uint8_t> bytes) {
  return static_cast<int64_t>(ReadBigEndian(bytes.first(8)));
}

std::string FingerprintError(std::span<const uint8_t> bytes, const char* type, int64_t expected) {
  const uint64_t found = ReadBigEndian(bytes.first(std::min<size_t>(8, bytes.size())));
  if (bytes.size() >= 8 && static_cast<int64_t>(found) != expected) {
    char text[160];
    std::snprintf(text, sizeof(text),
                  "%s: the type fingerprint is %016llx, expected %016llx; the sender uses another "
                  "version or type",
                  type, static_cast<unsigned long long>(found),
                  static_cast<unsigned long long>(expected));
    return text;
  }
  return std::string(type) + ": the message of " + std::to_string(bytes.size()) +
         " bytes is truncated, or it contains an impossible length";
}

}  // namespace envelope
}  // namespace vismap
