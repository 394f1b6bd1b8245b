#include "wire/envelope.h"

#include <cstdio>

namespace vismap::envelope {

int64_t ChecksumAfter(std::span<const uint8_t> bytes, size_t checksum_offset) {
  const auto sum = static_cast<int64_t>(Checksum64(bytes.subspan(checksum_offset + 8)));
  return sum == 0 ? 1 : sum;
}

void WriteBigEndian(int64_t value, uint8_t* destination) {
  const auto bits = static_cast<uint64_t>(value);
  for (int i = 0; i < 8; ++i) destination[i] = static_cast<uint8_t>(bits >> (8 * (7 - i)));
}

std::string FingerprintError(std::span<const uint8_t> bytes, const char* type, int64_t expected) {
  uint64_t found = 0;
  for (size_t i = 0; i < 8 && i < bytes.size(); ++i) found = (found << 8) | bytes[i];
  if (bytes.size() >= 8 && static_cast<int64_t>(found) != expected) {
    char text[160];
    std::snprintf(
        text, sizeof(text),
        "%s: type fingerprint %016llx, expected %016llx; the sender has another version or type",
        type, static_cast<unsigned long long>(found), static_cast<unsigned long long>(expected));
    return text;
  }
  return std::string(type) + ": truncated, or a length in it is impossible, in " +
         std::to_string(bytes.size()) + " bytes";
}

}  // namespace vismap::envelope
