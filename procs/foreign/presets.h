#pragma once

#include <set>
#include <string>

#include "base/result.h"
#include "config/process_options.h"

namespace vismap {

/// "none", for color_channel: a camera without colour.
inline constexpr const char* kNoChannel = "none";

/// Sets the keys that are not given to those of the preset. kAuto and kNone set nothing.
AdapterOptions WithPreset(AdapterOptions options);

/// The preset that fits the channels of a log; kAuto when none does.
AdapterPreset FindPreset(const std::set<std::string>& channels);

/// Fails, naming the key, when a key that is needed is still missing, or when the keys contradict
/// each other. For options that have their preset.
Result<void> CheckComplete(const AdapterOptions& options);

/// Whether a channel has this name, where an ending * of `pattern` stands for any ending.
bool ChannelMatches(const std::string& pattern, const std::string& channel);
/// The regular expression with which LCM subscribes to it.
std::string ChannelExpression(const std::string& pattern);

/// Every channel that the options name, each once.
std::set<std::string> ChannelsOf(const AdapterOptions& options);

}  // namespace vismap
