#include "foreign/presets.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "foreign/mount.h"
#include "wire/channels.h"

namespace vismap {
namespace {

AdapterCameraOptions Dimos() {
  AdapterCameraOptions options;
  options.color_channel = "/color_image#sensor_msgs.Image";
  options.depth_channel = "/depth_image#sensor_msgs.Image";
  options.intrinsics_channel = "/camera_info#sensor_msgs.CameraInfo";
  options.depth_intrinsics_channel = "/depth_camera_info#sensor_msgs.CameraInfo";
  options.pose_channels = {"/tf#tf2_msgs.TFMessage"};
  options.root = "world";
  options.body_frame = "base_link";
  return options;
}

AdapterCameraOptions Botcore() {
  AdapterCameraOptions options;
  options.color_channel = options.depth_channel = "OPENNI_FRAME";
  options.pose_channels = {"OPENNI_FRAME_LEFT_TO_LOCAL"};
  options.root = "local";
  options.camera_frame = "OPENNI_FRAME_LEFT";
  options.body_frame = "body";
  return options;
}

AdapterCameraOptions Drake() {
  AdapterCameraOptions options;
  options.color_channel = options.depth_channel = "DRAKE_RGBD_CAMERA_IMAGES_*";
  options.pose_channels = {"DRAKE_VIEWER_DRAW"};
  options.root = "world";
  options.body_frame = "base_link";
  return options;
}

AdapterCameraOptions OfPreset(AdapterPreset preset) {
  switch (preset) {
    case AdapterPreset::kDimos:
      return Dimos();
    case AdapterPreset::kBotcore:
      return Botcore();
    case AdapterPreset::kDrake:
      return Drake();
    case AdapterPreset::kAuto:
    case AdapterPreset::kNone:
      break;
  }
  return {};
}

}  // namespace

AdapterCameraOptions WithPreset(AdapterCameraOptions options) {
  const AdapterCameraOptions preset = OfPreset(options.preset);
  const auto set = [&](auto AdapterCameraOptions::*key) {
    if ((options.*key).empty()) options.*key = preset.*key;
  };
  set(&AdapterCameraOptions::color_channel);
  set(&AdapterCameraOptions::depth_channel);
  if (options.intrinsics.empty()) set(&AdapterCameraOptions::intrinsics_channel);
  set(&AdapterCameraOptions::depth_intrinsics_channel);
  set(&AdapterCameraOptions::pose_channels);
  set(&AdapterCameraOptions::root);
  set(&AdapterCameraOptions::camera_frame);
  set(&AdapterCameraOptions::body_frame);
  return options;
}

AdapterOptions WithPreset(AdapterOptions options) {
  if (options.camera.empty()) {
    AdapterCameraOptions& own = options;
    own = WithPreset(own);
  }
  for (AdapterCameraOptions& camera : options.camera) camera = WithPreset(camera);
  return options;
}

std::vector<AdapterCameraOptions> CamerasOf(const AdapterOptions& options) {
  return options.camera.empty() ? std::vector<AdapterCameraOptions>{options} : options.camera;
}

AdapterPreset FindPreset(const std::set<std::string>& channels) {
  for (const AdapterPreset preset :
       {AdapterPreset::kDimos, AdapterPreset::kBotcore, AdapterPreset::kDrake}) {
    const std::string depth = OfPreset(preset).depth_channel;
    if (std::any_of(channels.begin(), channels.end(),
                    [&](const std::string& channel) { return ChannelMatches(depth, channel); }))
      return preset;
  }
  return AdapterPreset::kAuto;
}

Result<void> CheckComplete(const AdapterCameraOptions& options) {
  if (options.depth_channel.empty()) {
    return Fail(
        "adapter.depth_channel is not set; give it, or adapter.preset (DIMOS, BOTCORE or "
        "DRAKE)");
  }
  if (options.color_channel.empty())
    return Fail("adapter.color_channel is not set; \"none\" stands for a camera without colour");
  if (options.intrinsics.empty() && options.intrinsics_channel.empty()) {
    return Fail(
        "adapter.intrinsics is not set: give fx, fy, cx, cy of the camera in pixels, since "
        "no message has them");
  }
  if (options.root.empty())
    return Fail("adapter.root is not set: the frame in which the camera moves");
  if (options.pose_channels.empty()) return Fail("adapter.pose_channels is not set");
  if (options.camera_frame.empty() && options.preset == AdapterPreset::kDrake) {
    return Fail(
        "adapter.camera_frame is not set: the link of the camera's optical frame, or the "
        "frame of a mount in adapter.mounts");
  }
  for (const std::string& mount : options.mounts) {
    if (const auto parsed = ParseMount(mount); !parsed)
      return Fail("adapter.mounts: " + parsed.error().message);
  }
  return {};
}

Result<void> CheckComplete(const std::vector<AdapterCameraOptions>& cameras) {
  const auto name = [](const AdapterCameraOptions& camera) {
    return "camera " + std::to_string(camera.camera_id);
  };
  std::map<std::string, std::string> readers;  // of channels of depth images
  for (const AdapterCameraOptions& camera : cameras) {
    if (const Result<void> complete = CheckComplete(camera); !complete) {
      if (cameras.size() == 1) return complete;
      return Fail(name(camera) + ": " + complete.error().message);
    }
    if (camera.root != cameras.front().root) {
      return Fail("adapter.root is '" + cameras.front().root + "' of " + name(cameras.front()) +
                  " and '" + camera.root + "' of " + name(camera) +
                  "; all cameras must have the frame that the map is in");
    }
    const auto [reader, first] = readers.emplace(camera.depth_channel, name(camera));
    if (!first) {
      return Fail("adapter.depth_channel is " + camera.depth_channel + " of " + reader->second +
                  " and of " + name(camera) + "; every camera needs channels of its own");
    }
  }
  return {};
}

bool IsPattern(const std::string& channel) { return channel.ends_with('*'); }

bool ChannelMatches(const std::string& pattern, const std::string& channel) {
  if (!IsPattern(pattern)) return channel == pattern;
  return channel.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1));
}

std::string ChannelExpression(const std::string& pattern) {
  if (!IsPattern(pattern)) return ExpressionFor(pattern);
  return ExpressionFor(std::string_view(pattern).substr(0, pattern.size() - 1)) + ".*";
}

std::set<std::string> ChannelsOf(const AdapterCameraOptions& options) {
  std::set<std::string> channels(options.pose_channels.begin(), options.pose_channels.end());
  channels.insert({options.color_channel, options.depth_channel, options.intrinsics_channel,
                   options.depth_intrinsics_channel});
  channels.erase("");
  channels.erase(kNoChannel);
  return channels;
}

}  // namespace vismap
