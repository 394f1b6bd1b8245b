#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "wire/channels.h"

namespace vismap {

/// One of the channels in kAllChannels and its message type, for code that handles all channels
/// alike and does not name the C++ type.
struct ChannelType {
  Channel channel;
  const char* type;     ///< name of the message type, for example "rgbd_frame_t"
  int64_t fingerprint;  ///< of the message type, from LCM
  /// Decodes the bytes as a message of this type. Fails with the sentence that Unpack gives.
  Result<void> (*check)(std::span<const uint8_t> bytes, const Channel& channel);
};

/// All channels, in the order of kAllChannels.
std::span<const ChannelType> ChannelTypes();

/// The entry of a channel by name; nullptr when vismap does not define this channel.
const ChannelType* FindChannelType(const std::string& channel);

}  // namespace vismap
