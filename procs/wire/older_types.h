#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"

namespace vismap {

/// A version of a message type that earlier releases have sent. Logs of it stay readable, and a
/// process understands what an older one says: such a message is converted to the current version
/// before it is decoded.
struct OlderType {
  int64_t fingerprint = 0;  ///< of the older version
  int64_t current = 0;      ///< fingerprint of the current version
  /// The encoded message in the current version. Fails as Unpack does.
  Result<std::vector<uint8_t>> (*convert)(std::span<const uint8_t> bytes,
                                          size_t max_bytes) = nullptr;
};

/// The older version with this fingerprint; nullptr if there is none.
const OlderType* FindOlderType(int64_t fingerprint);

/// The message in the current version of its type; nullopt if it is not of an older version. Fails
/// when it is one, but has more than `max_bytes`, cannot be decoded or has a wrong checksum.
std::optional<Result<std::vector<uint8_t>>> ConvertOlderMessage(std::span<const uint8_t> bytes,
                                                                size_t max_bytes);

}  // namespace vismap
