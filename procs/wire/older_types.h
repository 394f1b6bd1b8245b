#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace vismap {

/// Versions of message types that earlier releases have sent. Logs of them stay readable, and a
/// process understands what an older one says: such a message is completed to the current version
/// before it is decoded.
struct OlderType {
  int64_t fingerprint = 0;   ///< of the older version
  int64_t current = 0;       ///< fingerprint of the current version
  size_t missing_bytes = 0;  ///< the current version has so many bytes more at its end; 0 is their
                             ///< default
};

/// The older version with this fingerprint; nullptr if there is none.
const OlderType* FindOlderType(int64_t fingerprint);

/// The message in the current version of its type; nullopt if it is not of an older version.
std::optional<std::vector<uint8_t>> CompleteOlderMessage(std::span<const uint8_t> bytes);

}  // namespace vismap
