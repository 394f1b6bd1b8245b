// ScanNet as its SensReader exports it: color/N.jpg, depth/N.png (16-bit, mm), pose/N.txt (4x4
// matrix T_W_C; -inf = tracking was lost), intrinsic/intrinsic_depth.txt and
// intrinsic/intrinsic_color.txt (4x4). 30 frames per second. Colour of another size than depth is
// resampled to the depth camera with the two intrinsics (nearest neighbour). Colour of the same
// size counts as registered to depth.
#include "datasets/formats.h"
#include "datasets/image_file.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

bool LooksLikeScanNet(const fs::path& folder) {
  return fs::is_directory(folder / "color") && fs::is_directory(folder / "depth") &&
         fs::is_directory(folder / "pose");
}

Result<PinholeCamera> ReadScanNetIntrinsics(const fs::path& path) {
  const Result<std::vector<double>> k = ReadNumbers(path, 16);
  if (!k) return Fail(k.error().message);
  return PinholeCamera{.fx = (*k)[0], .fy = (*k)[5], .cx = (*k)[2], .cy = (*k)[6]};
}

/// The colour camera if colour has another size than depth, else none.
Result<std::optional<PinholeCamera>> FindColorCamera(const fs::path& folder,
                                                     const PinholeCamera& depth_camera,
                                                     const std::vector<FrameFiles>& frames) {
  const Result<ImageFileInfo> info = FirstInfo(frames, &FrameFiles::color);
  if (!info) return std::nullopt;  // no colour can be read
  if (info->width == depth_camera.width && info->height == depth_camera.height) return std::nullopt;
  const fs::path path = folder / "intrinsic" / "intrinsic_color.txt";
  Result<PinholeCamera> camera = ReadScanNetIntrinsics(path);
  if (!camera) return Fail(camera.error().message);
  camera->width = info->width;
  camera->height = info->height;
  if (const auto checked = ValidateCamera(*camera); !checked) {
    return Fail(path.string() + ": " + checked.error().message);
  }
  return *camera;
}

Result<SequenceFiles> ListScanNet(const fs::path& folder) {
  const Result<PinholeCamera> intrinsics =
      ReadScanNetIntrinsics(folder / "intrinsic" / "intrinsic_depth.txt");
  if (!intrinsics) return Fail(intrinsics.error().message);
  Result<std::vector<FrameFiles>> frames =
      PairByNumber({folder / "color", "", {".jpg", ".png"}}, {folder / "depth", "", {".png"}});
  if (!frames) return Fail(frames.error().message);
  for (FrameFiles& frame : *frames) {
    frame.utime = UtimeAtRate(frame.number, kUsualRate);
    if (!frame.missing.empty()) continue;
    const std::string name = frame.depth.stem().string() + ".txt";
    const Result<Result<Pose>> pose = ReadPoseFile(folder / "pose" / name);
    frame.T_W_C = pose ? *pose : Fail(pose.error().message);
  }
  const Result<ImageFileInfo> depth = FirstInfo(*frames, &FrameFiles::depth);
  if (!depth) return Fail(depth.error().message);
  SequenceFiles files;
  files.known_camera =
      KnownCamera{*intrinsics, (folder / "intrinsic" / "intrinsic_depth.txt").string(), false};
  files.known_camera->camera.width = depth->width;
  files.known_camera->camera.height = depth->height;
  const auto color_camera = FindColorCamera(folder, files.known_camera->camera, *frames);
  if (!color_camera) return Fail(color_camera.error().message);
  files.color_camera = *color_camera;
  files.frames = std::move(*frames);
  return files;
}

}  // namespace

const DatasetFormat kScanNetFormat{"scannet", "color/, depth/ and pose/", LooksLikeScanNet,
                                   ListScanNet};

}  // namespace vismap
