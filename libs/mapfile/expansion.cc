#include "mapfile/expansion.h"

#include <algorithm>

namespace vismap::mapfile {
namespace {

// Memory of an entry of a list, as protobuf holds it and as the map does, and of each of its bytes:
// a few bytes of evidence become a node of a table [bytes].
constexpr size_t kPerEntry = 256, kPerByte = 8;

// Removes a number of variable length from the front; what is left is empty when it is cut.
uint64_t TakeVarint(std::span<const uint8_t>& bytes) {
  uint64_t value = 0;
  for (int shift = 0; !bytes.empty() && shift < 64; shift += 7) {
    const uint8_t byte = bytes.front();
    bytes = bytes.subspan(1);
    value |= uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80) break;
  }
  return value;
}

}  // namespace

size_t ExpandedBytes(std::span<const uint8_t> message) {
  enum Kind : uint64_t { kVarint = 0, kFixed64 = 1, kText = 2, kFixed32 = 5 };
  size_t entries = 0;
  const size_t size = message.size();
  while (!message.empty()) {
    ++entries;
    size_t skip = 0;
    switch (TakeVarint(message) & 7) {
      case kVarint:
        TakeVarint(message);
        break;
      case kFixed64:
        skip = 8;
        break;
      case kFixed32:
        skip = 4;
        break;
      case kText:
        skip = static_cast<size_t>(TakeVarint(message));
        break;
      default:
        skip = message.size();  // protobuf will refuse it
    }
    message = message.subspan(std::min(skip, message.size()));
  }
  return entries * kPerEntry + size * kPerByte;
}

}  // namespace vismap::mapfile
