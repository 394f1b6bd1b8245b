#pragma once

#include <array>
#include <cstddef>
#include <string_view>

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
inline constexpr Channel kMapRequestChannel{"MAP_REQUEST", kMegabyte / 16};  ///< map_request_t
inline constexpr Channel kMapReplyChannel{"MAP_REPLY", 192 * kMegabyte};     ///< map_reply_t
inline constexpr Channel kStatusChannel{"STATUS", kMegabyte / 16};           ///< process_status_t

inline constexpr std::array kAllChannels = {
    kRgbdFrameChannel,     kDetectionsChannel,      kSegmentedFrameChannel, kMapCommitChannel,
    kMapDeltaChannel,      kMeshDeltaChannel,       kObjectsChannel,        kOctomapChannel,
    kMapRequestChannel,    kMapReplyChannel,        kStatusChannel,         kOctomapRawChannel,
    kOctomapCoarseChannel, kOctomapInflatedChannel, kOctomapDeltaChannel,   kNavigationChannel};

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

}  // namespace vismap
