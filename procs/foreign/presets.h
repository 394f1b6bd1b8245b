#pragma once

#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "config/process_options.h"

namespace vismap {

/// "none", for color_channel: a camera without colour.
inline constexpr const char* kNoChannel = "none";

/// Sets the keys that are not given to those of the preset. kAuto and kNone set nothing.
AdapterCameraOptions WithPreset(AdapterCameraOptions options);
/// The same for each of the cameras, or for the options themselves when they list none.
AdapterOptions WithPreset(AdapterOptions options);

/// The preset that fits the channels of a log; kAuto when none does.
AdapterPreset FindPreset(const std::set<std::string>& channels);

/// The cameras of the options: those listed, or the one that the options themselves are.
std::vector<AdapterCameraOptions> CamerasOf(const AdapterOptions& options);

/// Fails, naming the key, when a key that is needed is still missing, or when the keys contradict
/// each other. For options that have their preset.
Result<void> CheckComplete(const AdapterCameraOptions& options);
/// The same for several cameras, which must have one root, and must not read the same images.
Result<void> CheckComplete(const std::vector<AdapterCameraOptions>& cameras);

/// Whether a * at its end stands for any ending.
bool IsPattern(const std::string& channel);
/// Whether a channel has this name, where an ending * of `pattern` stands for any ending.
bool ChannelMatches(const std::string& pattern, const std::string& channel);
/// The regular expression with which LCM subscribes to it.
std::string ChannelExpression(const std::string& pattern);

/// Every channel that the options name, each once.
std::set<std::string> ChannelsOf(const AdapterCameraOptions& options);

}  // namespace vismap
