#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace vismap {

/// A channel of the bus. It carries one message type. LCM subscribes by regular expression, so a
/// name has only capital letters and underscores.
struct Channel {
  const char* name;
  size_t max_bytes;  ///< readers reject a larger message [bytes]
};

inline constexpr size_t kMegabyte = size_t{1} << 20;

inline constexpr Channel kRgbdFrameChannel{"RGBD_FRAME", 64 * kMegabyte};   ///< rgbd_frame_t
inline constexpr Channel kDetectionsChannel{"DETECTIONS", 16 * kMegabyte};  ///< detections_t
inline constexpr Channel kSegmentedFrameChannel{"SEGMENTED_FRAME",
                                                64 * kMegabyte};              ///< segmented_frame_t
inline constexpr Channel kMapCommitChannel{"MAP_COMMIT", kMegabyte / 16};     ///< frame_commit_t
inline constexpr Channel kMapDeltaChannel{"MAP_DELTA", 64 * kMegabyte};       ///< map_delta_t
inline constexpr Channel kMeshDeltaChannel{"MESH_DELTA", 64 * kMegabyte};     ///< mesh_delta_t
inline constexpr Channel kObjectsChannel{"OBJECTS", 16 * kMegabyte};          ///< object_list_t
inline constexpr Channel kOctomapChannel{"OCTOMAP", 192 * kMegabyte};         ///< octree_t
inline constexpr Channel kOctomapRawChannel{"OCTOMAP_RAW", 192 * kMegabyte};  ///< octree_t
inline constexpr Channel kOctomapCoarseChannel{"OCTOMAP_COARSE", 192 * kMegabyte};  ///< octree_t
inline constexpr Channel kOctomapInflatedChannel{"OCTOMAP_INFLATED",
                                                 192 * kMegabyte};               ///< octree_t
inline constexpr Channel kOctomapDeltaChannel{"OCTOMAP_DELTA", 64 * kMegabyte};  ///< octree_delta_t
inline constexpr Channel kNavigationChannel{"NAVIGATION", kMegabyte / 16};  ///< navigation_status_t
inline constexpr Channel kGridChannel{"GRID", 192 * kMegabyte};             ///< occupancy_grid_t
inline constexpr Channel kDistancesChannel{"DISTANCES", 64 * kMegabyte};    ///< distance_field_t
inline constexpr Channel kPoseCorrectionChannel{"POSE_CORRECTION",
                                                32 * kMegabyte};             ///< pose_correction_t
inline constexpr Channel kMapRequestChannel{"MAP_REQUEST", kMegabyte / 16};  ///< map_request_t
inline constexpr Channel kMapReplyChannel{"MAP_REPLY", 192 * kMegabyte};     ///< map_reply_t
inline constexpr Channel kStatusChannel{"STATUS", kMegabyte / 16};           ///< process_status_t

inline constexpr std::array kAllChannels = {
    kRgbdFrameChannel,     kDetectionsChannel,      kSegmentedFrameChannel, kMapCommitChannel,
    kMapDeltaChannel,      kMeshDeltaChannel,       kObjectsChannel,        kOctomapChannel,
    kMapRequestChannel,    kMapReplyChannel,        kStatusChannel,         kOctomapRawChannel,
    kOctomapCoarseChannel, kOctomapInflatedChannel, kOctomapDeltaChannel,   kNavigationChannel,
    kGridChannel,          kDistancesChannel,       kPoseCorrectionChannel};

/// The largest message of any channel [bytes].
inline constexpr size_t kMaxMessageBytes = 192 * kMegabyte;

/// The largest message of a channel [bytes]; kMaxMessageBytes for a channel that vismap does not
/// define.
constexpr size_t MaxBytesOf(std::string_view channel) {
  for (const Channel& known : kAllChannels) {
    if (channel == known.name) return known.max_bytes;
  }
  return kMaxMessageBytes;
}

// Other programs may have channels with names of ours: director reads another type on OCTOMAP. So a
// prefix can stand before the names of all our channels on a bus: with "vismap/" the channel
// OCTOMAP is vismap/OCTOMAP there. The code knows the names without it; what connects to a bus or
// opens a log puts it on and takes it off.

/// The longest channel name that LCM sends [bytes].
inline constexpr size_t kMaxChannelName = 63;

/// Fails when a prefix has other characters than letters, digits and `_ - / . #`, or leaves no room
/// for our longest name.
Result<void> CheckChannelPrefix(std::string_view prefix);

/// The name of ours that a channel of the bus has; nullopt when it does not begin with the prefix.
std::optional<std::string> WithoutPrefix(const std::string& on_bus, const std::string& prefix);

/// For programs that serve pipelines with any prefix: the name of ours with which a channel ends,
/// after `prefix` or after `/`, `.`, `-` or `#`; else the whole name.
std::string_view NameOfOurs(std::string_view on_bus, std::string_view prefix);

/// The regular expression that matches this channel name alone.
std::string ExpressionFor(std::string_view channel);

}  // namespace vismap
