#include "wire/older_types.h"

#include <algorithm>
#include <array>
#include <vismap/process_status_t.hpp>

#include "wire/envelope.h"

namespace vismap {
namespace {

std::span<const OlderType> OlderTypes() {
  static const std::array<OlderType, 1> kTypes = {
      // process_status_t before it had findings
      OlderType{static_cast<int64_t>(0xdfd3012ff7311f8a), process_status_t::getHash(), 4}};
  return kTypes;
}

}  // namespace

const OlderType* FindOlderType(int64_t fingerprint) {
  const std::span<const OlderType> types = OlderTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const OlderType& type) {
    return type.fingerprint == fingerprint;
  });
  return found == types.end() ? nullptr : &*found;
}

std::optional<std::vector<uint8_t>> CompleteOlderMessage(std::span<const uint8_t> bytes) {
  if (bytes.size() < 8) return std::nullopt;
  const OlderType* older = FindOlderType(envelope::ReadFingerprint(bytes));
  if (older == nullptr) return std::nullopt;
  std::vector<uint8_t> completed(bytes.begin(), bytes.end());
  completed.resize(bytes.size() + older->missing_bytes);
  envelope::WriteBigEndian(older->current, completed.data());
  return completed;
}

}  // namespace vismap
