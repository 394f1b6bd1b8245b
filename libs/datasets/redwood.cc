// Redwood / Open3D: color/N.jpg, depth/N.png (16-bit, mm) and trajectory.log, whose k-th pose is
// that of the k-th image. The camera is that of intrinsics.txt ("width height fx fy cx cy
// units_per_metre"), or, without that file, the PrimeSense default of Redwood. 30 frames per
// second.
#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

bool LooksLikeRedwood(const fs::path& folder) {
  return fs::is_directory(folder / "color") && fs::is_directory(folder / "depth") &&
         fs::exists(folder / "trajectory.log");
}

struct RedwoodCamera {
  PinholeCamera camera{640, 480, 525, 525, 319.5, 239.5};
  double units = 1000;  ///< depth steps per metre
};

Result<RedwoodCamera> ReadRedwoodCamera(const fs::path& path) {
  if (!fs::exists(path)) return RedwoodCamera{};
  const Result<std::vector<double>> n = ReadNumbers(path, 7);
  if (!n) return Fail(n.error().message);
  if (!((*n)[0] >= 1 && (*n)[0] <= 16384 && (*n)[1] >= 1 && (*n)[1] <= 16384 && (*n)[6] >= 1)) {
    return Fail(
        path.string() +
        ": expected \"width height fx fy cx cy units_per_metre\" with sides in 1..16384 and "
        "at least 1 unit per metre");
  }
  return RedwoodCamera{
      {static_cast<int>((*n)[0]), static_cast<int>((*n)[1]), (*n)[2], (*n)[3], (*n)[4], (*n)[5]},
      (*n)[6]};
}

Result<SequenceFiles> ListRedwood(const fs::path& folder) {
  const Result<RedwoodCamera> parameters = ReadRedwoodCamera(folder / "intrinsics.txt");
  if (!parameters) return Fail(parameters.error().message);
  Result<std::vector<FrameFiles>> frames =
      PairByNumber({folder / "color", "", {".jpg", ".png"}}, {folder / "depth", "", {".png"}});
  if (!frames) return Fail(frames.error().message);
  const Result<std::vector<LoggedPose>> poses = ReadTrajectoryLog(folder / "trajectory.log");
  if (!poses) return Fail(poses.error().message);
  for (size_t k = 0; k < frames->size(); ++k) {
    FrameFiles& frame = (*frames)[k];
    frame.utime = UtimeAtRate(frame.number, kUsualRate);
    frame.T_W_C = k < poses->size()
                      ? (*poses)[k].T_W_C
                      : Fail("trajectory.log has only " + std::to_string(poses->size()) + " poses");
  }
  return SequenceFiles{.camera = parameters->camera,
                       .depth_from = {},
                       .color_camera = {},
                       .depth_unit_m = 1 / parameters->units,
                       .frames = std::move(*frames)};
}

}  // namespace

const DatasetFormat kRedwoodFormat{"redwood", "color/, depth/ and trajectory.log", LooksLikeRedwood,
                                   ListRedwood};

}  // namespace vismap
