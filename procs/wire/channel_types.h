#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "wire/channels.h"

namespace vismap {

/// What is known of one of our channels without knowing its message type in C++.
struct ChannelType {
  Channel channel;
  const char* type;     ///< name of the message type
  int64_t fingerprint;  ///< of the type
  /// Fails when the bytes are not such a message, as a reader on the bus would say.
  Result<void> (*check)(std::span<const uint8_t> bytes, const Channel& channel);
};

/// All of ours, in the order of kAllChannels.
std::span<const ChannelType> ChannelTypes();

/// None for a channel that is not ours.
const ChannelType* FindChannelType(const std::string& channel);

}  // namespace vismap
