#include "wire/channel_types.h"

#include <algorithm>
#include <array>
#include <vismap/detections_t.hpp>
#include <vismap/distance_field_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/occupancy_grid_t.hpp>
#include <vismap/octree_delta_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/pose_correction_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "wire/envelope.h"

namespace vismap {
namespace {

template <typename Message>
ChannelType TypeOf(const Channel& channel) {
  return {channel, Message::getTypeName(), Message::getHash(),
          [](std::span<const uint8_t> bytes, const Channel& of) -> Result<void> {
            const Result<Message> message = Unpack<Message>(bytes, of.max_bytes);
            if (!message) return tl::unexpected(message.error());
            return {};
          }};
}

}  // namespace

std::span<const ChannelType> ChannelTypes() {
  static const std::array kTypes = {TypeOf<rgbd_frame_t>(kRgbdFrameChannel),
                                    TypeOf<detections_t>(kDetectionsChannel),
                                    TypeOf<segmented_frame_t>(kSegmentedFrameChannel),
                                    TypeOf<frame_commit_t>(kMapCommitChannel),
                                    TypeOf<map_delta_t>(kMapDeltaChannel),
                                    TypeOf<mesh_delta_t>(kMeshDeltaChannel),
                                    TypeOf<object_list_t>(kObjectsChannel),
                                    TypeOf<octree_t>(kOctomapChannel),
                                    TypeOf<map_request_t>(kMapRequestChannel),
                                    TypeOf<map_reply_t>(kMapReplyChannel),
                                    TypeOf<process_status_t>(kStatusChannel),
                                    TypeOf<octree_t>(kOctomapRawChannel),
                                    TypeOf<octree_t>(kOctomapCoarseChannel),
                                    TypeOf<octree_t>(kOctomapInflatedChannel),
                                    TypeOf<octree_delta_t>(kOctomapDeltaChannel),
                                    TypeOf<navigation_status_t>(kNavigationChannel),
                                    TypeOf<occupancy_grid_t>(kGridChannel),
                                    TypeOf<distance_field_t>(kDistancesChannel),
                                    TypeOf<pose_correction_t>(kPoseCorrectionChannel)};
  return kTypes;
}

const ChannelType* FindChannelType(const std::string& channel) {
  const std::span<const ChannelType> types = ChannelTypes();
  const auto found = std::find_if(types.begin(), types.end(), [&](const ChannelType& type) {
    return channel == type.channel.name;
  });
  return found == types.end() ? nullptr : &*found;
}

}  // namespace vismap
