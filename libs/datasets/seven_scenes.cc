// 7-Scenes: frame-NNNNNN.color.{png,jpg}, frame-NNNNNN.depth.png (16-bit, mm; 65535 and 0 = no
// return), frame-NNNNNN.pose.txt (4x4 matrix from the depth camera to W), and optionally
// camera-intrinsics.txt (3x3, of the depth camera). 30 frames per second.
#include <algorithm>
#include <initializer_list>

#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

// The intrinsics that the authors of the data set give for its depth camera.
constexpr PinholeCamera kDefaultCamera{
    .width = 640, .height = 480, .fx = 585, .fy = 585, .cx = 320, .cy = 240};

// Depth was recorded in the frame of the infrared camera, and the authors give no calibration to
// the colour camera. Without registration, masks are off by up to 20 pixels from the depth of their
// objects. With the nominal colour camera of a Kinect (OpenNI), the error is one or two pixels: in
// redkitchen, the edges of depth and colour agree best for fx 528 and a baseline of 22 mm.
constexpr PinholeCamera kKinectColor{
    .width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 320, .cy = 240};
constexpr double kKinectBaseline = 0.025;  // [m] along x

bool IsKinectDepth(const PinholeCamera& camera) {
  return camera.fx == kDefaultCamera.fx && camera.fy == kDefaultCamera.fy &&
         camera.cx == kDefaultCamera.cx && camera.cy == kDefaultCamera.cy;
}

// Whether a folder of the path has a name of the data set: its own, or that of a scene above a
// sequence "seq-NN".
bool IsNamedAsSevenScenes(const fs::path& folder) {
  const auto is_one_of = [](const std::string& name, std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool sequence = folder.filename().string().starts_with("seq-");
  return std::any_of(folder.begin(), folder.end(), [&](const fs::path& part) {
    const std::string name = part.string();
    return is_one_of(name, {"7scenes", "7-scenes", "7Scenes", "7-Scenes", "redkitchen"}) ||
           (sequence && is_one_of(name, {"chess", "fire", "heads", "office", "pumpkin", "stairs"}));
  });
}

bool LooksLikeSevenScenes(const fs::path& folder) {
  const auto poses = ListNumberedFiles({folder, "frame-", {".pose.txt"}});
  const auto depths = ListNumberedFiles({folder, "frame-", {".depth.png"}});
  return poses && depths && !poses->empty() && !depths->empty();
}

Result<KnownCamera> ReadSevenScenesIntrinsics(const fs::path& path) {
  if (!fs::exists(path)) {
    return KnownCamera{
        kDefaultCamera,
        "assumed for the Kinect of 7-Scenes (there is no " + path.filename().string() + ")", true};
  }
  const Result<std::vector<double>> k = ReadNumbers(path, 9);
  if (!k) return Fail(k.error().message);
  return KnownCamera{
      {.fx = (*k)[0], .fy = (*k)[4], .cx = (*k)[2], .cy = (*k)[5]}, path.string(), false};
}

Result<SequenceFiles> ListSevenScenes(const fs::path& folder) {
  Result<std::vector<FrameFiles>> frames = PairByNumber(
      {folder, "frame-", {".color.png", ".color.jpg"}}, {folder, "frame-", {".depth.png"}});
  if (!frames) return Fail(frames.error().message);
  for (FrameFiles& frame : *frames) {
    frame.utime = UtimeAtRate(frame.number, kUsualRate);
    if (!frame.missing.empty()) continue;
    std::string name = frame.depth.filename().string();
    name.replace(name.size() - std::string_view("depth.png").size(), std::string::npos, "pose.txt");
    const Result<Result<Pose>> pose = ReadPoseFile(folder / name);
    frame.T_W_C = pose ? *pose : Fail(pose.error().message);
  }
  SequenceFiles files;
  files.known_camera = ReadSevenScenesIntrinsics(folder / "camera-intrinsics.txt");
  if (!files.known_camera) return tl::unexpected(files.known_camera.error());
  files.may_be_kinect_depth = IsKinectDepth(files.known_camera->camera);
  files.named_as_seven_scenes = IsNamedAsSevenScenes(folder);
  files.frames = std::move(*frames);
  return files;
}

}  // namespace

Result<void> RegisterKinectDepth(SequenceFiles* files) {
  const PinholeCamera& recorded = files->camera;
  if (recorded.width != kKinectColor.width || recorded.height != kKinectColor.height) {
    return Fail("depth of a Kinect is registered for images of 640x480 only; these are " +
                std::to_string(recorded.width) + "x" + std::to_string(recorded.height));
  }
  DepthSource from{recorded, Pose::Identity()};
  from.T_C_D.translation() = Eigen::Vector3d(-kKinectBaseline, 0, 0);
  files->camera = kKinectColor;
  for (FrameFiles& frame : files->frames) {
    if (frame.T_W_C) frame.T_W_C = *frame.T_W_C * from.T_C_D.inverse();
  }
  files->depth_from = from;
  return {};
}

const DatasetFormat kSevenScenesFormat{"7scenes", "frame-N.depth.png and frame-N.pose.txt",
                                       LooksLikeSevenScenes, ListSevenScenes};

}  // namespace vismap
