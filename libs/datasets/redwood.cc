// Redwood / Open3D: color/N.jpg, depth/N.png (16-bit, mm), trajectory.log; the k-th image has the
// k-th pose of the log. intrinsics.txt ("width height fx fy cx cy units_per_metre") when there is
// one, else the PrimeSense default that Redwood names. 30 frames a second.
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

bool LooksLikeRedwood(const fs::path& folder) {
  return fs::is_directory(folder / "color") && fs::is_directory(folder / "depth") &&
         fs::exists(folder / "trajectory.log");
}

struct RedwoodCamera {
  KnownCamera camera;
  double steps_per_metre = 1000;
  std::string steps_source = "the format";
};

RedwoodCamera AssumedRedwoodCamera() {
  RedwoodCamera assumed;
  assumed.camera.camera = {640, 480, 525, 525, 319.5, 239.5};
  assumed.camera.source =
      "assumed for a Kinect (there is neither intrinsics.txt nor camera_intrinsic.json)";
  assumed.camera.assumed = true;
  return assumed;
}

// intrinsics.txt: "width height fx fy cx cy steps_per_metre".
Result<RedwoodCamera> ReadRedwoodText(const fs::path& path) {
  const Result<std::vector<double>> n = ReadNumbers(path, 7);
  if (!n) return Fail(n.error().message);
  if (!((*n)[0] >= 1 && (*n)[0] <= 16384 && (*n)[1] >= 1 && (*n)[1] <= 16384 && (*n)[6] >= 1)) {
    return Fail(
        path.string() +
        ": expected \"width height fx fy cx cy units_per_metre\" with sides in 1..16384 and "
        "at least 1 unit per metre");
  }
  RedwoodCamera stated;
  stated.camera.camera = {
      static_cast<int>((*n)[0]), static_cast<int>((*n)[1]), (*n)[2], (*n)[3], (*n)[4], (*n)[5]};
  stated.camera.source = path.string();
  stated.steps_per_metre = (*n)[6];
  stated.steps_source = path.string();
  return stated;
}

// camera_intrinsic.json, as Open3D's recorders write it: width, height, and the 3x3 matrix column
// by column.
Result<RedwoodCamera> ReadRedwoodJson(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  const Result<nlohmann::json> json = ParseJson(*text);
  if (!json) return Fail(path.string() + ": " + json.error().message);
  const auto size = [&](const char* key) {
    const auto found = json->is_object() ? json->find(key) : json->end();
    const bool number = json->is_object() && found != json->end() && found->is_number();
    const double value = number ? found->get<double>() : 0;
    return value >= 1 && value <= 16384 ? static_cast<int>(value) : 0;
  };
  std::vector<double> matrix;
  if (json->is_object() && json->contains("intrinsic_matrix")) {
    for (const auto& value : (*json)["intrinsic_matrix"])
      matrix.push_back(value.is_number() ? value.get<double>() : 0);
  }
  if (size("width") == 0 || size("height") == 0 || matrix.size() != 9) {
    return Fail(path.string() +
                ": expected {\"width\", \"height\", \"intrinsic_matrix\": 9 numbers}");
  }
  RedwoodCamera parameters;
  // Other tools write it row by row; then the principal point is in the third column.
  const bool by_rows = matrix[6] == 0 && matrix[7] == 0;
  parameters.camera.camera = {size("width"),
                              size("height"),
                              matrix[0],
                              matrix[4],
                              by_rows ? matrix[2] : matrix[6],
                              by_rows ? matrix[5] : matrix[7]};
  parameters.camera.source = path.string();
  return parameters;
}

Result<RedwoodCamera> ReadRedwoodCamera(const fs::path& folder) {
  if (fs::exists(folder / "intrinsics.txt")) return ReadRedwoodText(folder / "intrinsics.txt");
  if (fs::exists(folder / "camera_intrinsic.json"))
    return ReadRedwoodJson(folder / "camera_intrinsic.json");
  return AssumedRedwoodCamera();
}

// The number of frames up to the last one that has both images: a recorder that was stopped may
// have written one of the last frame's images only, and no pose.
size_t CountUpToLastPair(const std::vector<FrameFiles>& frames) {
  size_t count = frames.size();
  while (count > 0 && !frames[count - 1].missing.empty()) --count;
  return count;
}

// Poses belong to images by their order, so there must be as many.
Result<void> SetRedwoodPoses(const fs::path& path, std::vector<FrameFiles>* frames) {
  const Result<std::vector<LoggedPose>> poses = ReadTrajectoryLog(path);
  if (!poses) return Fail(poses.error().message);
  if (poses->size() != frames->size() && poses->size() != CountUpToLastPair(*frames)) {
    return Fail(path.string() + ": " + std::to_string(poses->size()) + " poses for " +
                std::to_string(frames->size()) +
                " images; which pose belongs to which image cannot be told");
  }
  for (size_t k = 0; k < poses->size(); ++k) (*frames)[k].T_W_C = (*poses)[k].T_W_C;
  return {};
}

Result<SequenceFiles> ListRedwood(const fs::path& folder) {
  const Result<RedwoodCamera> parameters = ReadRedwoodCamera(folder);
  if (!parameters) return Fail(parameters.error().message);
  Result<std::vector<FrameFiles>> frames =
      PairByNumber({folder / "color", "", {".jpg", ".png"}}, {folder / "depth", "", {".png"}});
  if (!frames) return Fail(frames.error().message);
  for (FrameFiles& frame : *frames) frame.utime = UtimeAtRate(frame.number, kUsualRate);
  if (const auto set = SetRedwoodPoses(folder / "trajectory.log", &*frames); !set)
    return tl::unexpected(set.error());
  SequenceFiles files;
  files.known_camera = parameters->camera;
  files.depth_unit_m = 1 / parameters->steps_per_metre;
  files.depth_unit_source = parameters->steps_source;
  files.frames = std::move(*frames);
  return files;
}

}  // namespace

const DatasetFormat kRedwoodFormat{"redwood", "color/, depth/ and trajectory.log", LooksLikeRedwood,
                                   ListRedwood};

}  // namespace vismap
