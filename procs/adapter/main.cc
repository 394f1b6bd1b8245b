#include "runtime/main.h"

#include <algorithm>
#include <string>
#include <vector>

#include "adapter/adapter.h"
#include "foreign/presets.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  VismapConfig config;
  std::string tf;
};

void AddOptions(CommandLine& line, Arguments* arguments) {
  AdapterOptions& adapter = arguments->config.adapter;
  line.Choice("--preset", &adapter.preset,
              "Whose programs publish the images: sets the channels and frames that are not given");
  line.Option("--robot-url", &adapter.robot_url,
              "URL of the robot's bus; if not given, that of --lcm-url");
  line.Option("--camera-id", &adapter.camera_id, "camera_id of the frames").AtLeast(0);
  line.Option("--color-image", &adapter.color_channel,
              "Channel of the colour images; none = a camera without colour");
  line.Option("--depth-image", &adapter.depth_channel, "Channel of the depth images");
  line.Option("--camera-info", &adapter.intrinsics_channel,
              "Channel of the colour camera's intrinsics");
  line.Option("--depth-camera-info", &adapter.depth_intrinsics_channel,
              "Channel of the depth camera's intrinsics");
  line.Option("--tf", &arguments->tf, "Channel of the poses");
  line.Option("--intrinsics", &adapter.intrinsics,
              "fx,fy,cx,cy of the camera in pixels, instead of a channel");
  line.Option("--root", &adapter.root, "Frame that the map is in");
  line.Option("--camera-frame", &adapter.camera_frame,
              "Optical frame of the camera; if not given, as the images say");
  line.Option("--global-map", &adapter.cloud_channel,
              "Publish the surface here, as a PointCloud2 on the robot's bus");
  line.Option("--global-costmap", &adapter.costmap_channel,
              "Publish the space here, as an OccupancyGrid");
  line.Option("--detections-3d", &adapter.detections_channel,
              "Publish the objects here, as a Detection3DArray");
  line.Choice("--swap-red-blue", &adapter.swap_red_blue, {{"false", false}, {"true", true}},
              "For drivers that send blue as red");
}

Result<void> Complete(Arguments* arguments) {
  AdapterOptions& adapter = arguments->config.adapter;
  if (!arguments->tf.empty()) adapter.pose_channels = {arguments->tf};
  adapter = WithPreset(adapter);
  return {};
}

Outcome Serve(const AdapterOptions& options, ProcessContext& context) {
  if (const auto complete = CheckComplete(options); !complete)
    return ExitWith(ExitCode::kUsage, complete.error().message);
  std::set<std::string> channels;
  for (const std::string& channel : ChannelsOf(options))
    channels.insert(ChannelExpression(channel));
  const std::string url = options.robot_url.empty() ? context.options.lcm_url : options.robot_url;
  const auto robot = RobotBus::Open(url, channels, context.options.connect_timeout, &context.stop);
  if (!robot) {
    if (context.stop.requested()) return {};
    return ExitWith(ExitCode::kFailed, robot.error().message);
  }
  const auto adapter = Adapter::Create(options, context.bus, context.status, robot->get());
  if (!adapter) return ExitWith(ExitCode::kUsage, adapter.error().message);
  (*adapter)->Run();
  return {};
}

// DimOS starts programs with underscores in the names of options.
std::vector<std::string> WithDashes(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  for (std::string& word : words) {
    if (!word.starts_with("--")) continue;
    const size_t end = std::min(word.find('='), word.size());
    std::replace(word.begin() + 2, word.begin() + static_cast<std::ptrdiff_t>(end), '_', '-');
  }
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "adapter";
  spec.summary =
      "Publishes the images and poses of other programs (DimOS, Drake, bot_core) as RGBD_FRAME.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec, [&] { return Complete(&arguments); });
  spec.run = [&](ProcessContext& context) { return Serve(arguments.config.adapter, context); };
  std::vector<std::string> words = WithDashes(argc, argv);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return RunProcess(argc, pointers.data(), spec);
}
