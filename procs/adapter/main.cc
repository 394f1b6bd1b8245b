#include "runtime/main.h"

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adapter/adapter.h"
#include "adapter/map_outputs.h"
#include "adapter/native_module.h"
#include "foreign/presets.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

/// What the command line says about the camera.
struct CameraOptions {
  std::optional<AdapterPreset> preset;
  std::optional<int> camera_id;
  std::optional<std::string> color_image, depth_image, camera_info, depth_camera_info, tf, root,
      camera_frame;
  std::vector<double> intrinsics;
  std::optional<bool> swap_red_blue;
};

struct Arguments {
  VismapConfig config;
  CameraOptions camera;
};

template <typename T>
bool SetIfGiven(const std::optional<T>& given, T* value) {
  if (given) *value = *given;
  return given.has_value();
}

/// Sets in the camera what the command line says. Returns whether it says something.
bool SetIn(const CameraOptions& given, AdapterCameraOptions* camera) {
  bool any = SetIfGiven(given.preset, &camera->preset);
  any |= SetIfGiven(given.camera_id, &camera->camera_id);
  any |= SetIfGiven(given.color_image, &camera->color_channel);
  any |= SetIfGiven(given.depth_image, &camera->depth_channel);
  any |= SetIfGiven(given.camera_info, &camera->intrinsics_channel);
  any |= SetIfGiven(given.depth_camera_info, &camera->depth_intrinsics_channel);
  any |= SetIfGiven(given.root, &camera->root);
  any |= SetIfGiven(given.camera_frame, &camera->camera_frame);
  any |= SetIfGiven(given.swap_red_blue, &camera->swap_red_blue);
  if (given.tf) camera->pose_channels = {*given.tf};
  if (!given.intrinsics.empty()) camera->intrinsics = given.intrinsics;
  return any || given.tf || !given.intrinsics.empty();
}

template <typename T>
using Choices = std::vector<std::pair<std::string, std::optional<T>>>;

void AddCameraOptions(CommandLine& line, CameraOptions* camera) {
  Choices<AdapterPreset> presets;
  for (const auto& [name, value] : NamesOf(AdapterPreset{}))
    presets.emplace_back(WordOf(name), value);
  line.Choice("--preset", &camera->preset, presets,
              "Whose programs publish the images: sets the channels and frames that are not given");
  line.Option("--camera-id", &camera->camera_id, "camera_id of the frames").AtLeast(0);
  line.Option("--color-image", &camera->color_image,
              "Channel of the colour images; none = a camera without colour");
  line.Option("--depth-image", &camera->depth_image, "Channel of the depth images");
  line.Option("--camera-info", &camera->camera_info, "Channel of the colour camera's intrinsics");
  line.Option("--depth-camera-info", &camera->depth_camera_info,
              "Channel of the depth camera's intrinsics");
  line.Option("--tf", &camera->tf, "Channel of the poses");
  line.Option("--intrinsics", &camera->intrinsics,
              "fx,fy,cx,cy of the camera in pixels, instead of a channel");
  line.Option("--root", &camera->root, "Frame that the map is in");
  line.Option("--camera-frame", &camera->camera_frame,
              "Optical frame of the camera; if not given, as the images say");
  line.Choice("--swap-red-blue", &camera->swap_red_blue,
              Choices<bool>{{"false", false}, {"true", true}}, "For drivers that send blue as red");
}

void AddOptions(CommandLine& line, Arguments* arguments, std::string* stdin_config) {
  AdapterOptions& adapter = arguments->config.adapter;
  AddCameraOptions(line, &arguments->camera);
  line.Option("--robot-url", &adapter.robot_url,
              "URL of the robot's bus; if not given, that of --lcm-url");
  line.Option("--global-map", &adapter.cloud_channel,
              "Publish the surface here, as a PointCloud2 on the robot's bus");
  line.Option("--global-costmap", &adapter.costmap_channel,
              "Publish the space here, as an OccupancyGrid");
  line.Option("--detections-3d", &adapter.detections_channel,
              "Publish the objects here, as a Detection3DArray");
  line.Option("--stdin-config", stdin_config,
              "true: also read options from one line of JSON on the standard input, as DimOS "
              "writes it")
      .OneOf({"false", "true"});
}

Result<void> Complete(Arguments* arguments) {
  AdapterOptions& adapter = arguments->config.adapter;
  AdapterCameraOptions* camera = adapter.camera.empty() ? &adapter : &adapter.camera.front();
  if (SetIn(arguments->camera, camera) && adapter.camera.size() > 1) {
    return Fail(
        "the config has several cameras (adapter.camera), so the command line cannot say "
        "something about one of them; give it in the config");
  }
  adapter = WithPreset(adapter);
  return {};
}

/// The thread that gives the map back; nullptr when no channel for it is named. `stop` ends its
/// connections later.
Result<std::unique_ptr<OutputThread>> StartOutputs(const AdapterOptions& options,
                                                   const std::string& url,
                                                   const ProcessContext& context,
                                                   StopSignal* stop) {
  if (!MapOutputs::Wanted(options)) return nullptr;
  CommonOptions once = context.options;
  once.connect_timeout = 0;
  const double timeout = context.options.connect_timeout;
  auto bus = OpenWithin(timeout, context.stop, [&] { return OpenBus(once, once.name, stop); });
  if (!bus) return tl::unexpected(bus.error());
  auto robot = OpenWithin(timeout, context.stop, [&] { return RobotBus::Open(url, {}, 0, stop); });
  if (!robot) return tl::unexpected(robot.error());
  return std::make_unique<OutputThread>(options, std::move(*bus), std::move(*robot), stop);
}

Outcome Serve(const AdapterOptions& options, ProcessContext& context) {
  const std::vector<AdapterCameraOptions> cameras = CamerasOf(options);
  if (const auto complete = CheckComplete(cameras); !complete)
    return ExitWith(ExitCode::kUsage, complete.error().message);
  if (const char* transport = std::getenv("DIMOS_TRANSPORT"); transport != nullptr) {
    if (const std::string problem = TransportProblem(transport); !problem.empty())
      LogWarning(problem);
  }
  std::set<std::string> channels;
  for (const AdapterCameraOptions& camera : cameras) {
    for (const std::string& channel : ChannelsOf(camera))
      channels.insert(ChannelExpression(channel));
  }
  const std::string url = options.robot_url.empty() ? context.options.lcm_url : options.robot_url;
  const auto robot = RobotBus::Open(url, channels, context.options.connect_timeout, &context.stop);
  if (!robot) {
    if (context.stop.requested()) return {};
    return ExitWith(ExitCode::kFailed, robot.error().message);
  }
  StopSignal stop_outputs;
  const auto outputs = StartOutputs(options, url, context, &stop_outputs);
  if (!outputs && context.stop.requested()) return {};
  if (!outputs) return ExitWith(ExitCode::kFailed, outputs.error().message);
  const auto adapter = Adapter::Create(options, context.bus, context.status, robot->get(),
                                       *outputs ? &(*outputs)->report() : nullptr);
  if (!adapter) return ExitWith(ExitCode::kUsage, adapter.error().message);
  (*adapter)->Run();
  return {};
}

// The command line, and what DimOS says on the standard input.
Result<std::vector<std::string>> ReadWords(int argc, char** argv) {
  constexpr double kTimeout = 10;  // [s]
  std::vector<std::string> words = WithDashes({argv, argv + argc});
  if (!WantsStdinConfig(words)) return words;
  const Result<std::string> line = ReadStdinLine(kTimeout);
  if (!line) return tl::unexpected(line.error());
  return WithStdinConfig(std::move(words), *line);
}

}  // namespace

int main(int argc, char** argv) {
  Result<std::vector<std::string>> words = ReadWords(argc, argv);
  if (!words) {
    std::fprintf(stderr, "vismap-adapter: %s\n", words.error().message.c_str());
    return static_cast<int>(ExitCode::kUsage);
  }
  Arguments arguments;
  std::string stdin_config = "false";
  ProcessSpec spec;
  spec.name = "adapter";
  spec.summary =
      "Publishes the images and poses of other programs (DimOS, Drake, bot_core) as RGBD_FRAME.";
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments, &stdin_config); };
  UseConfig(&arguments.config, &spec, [&] { return Complete(&arguments); });
  spec.run = [&](ProcessContext& context) { return Serve(arguments.config.adapter, context); };
  std::vector<char*> pointers;
  for (std::string& word : *words) pointers.push_back(word.data());
  const int count = static_cast<int>(pointers.size());
  pointers.push_back(nullptr);
  return RunProcess(count, pointers.data(), spec);
}
