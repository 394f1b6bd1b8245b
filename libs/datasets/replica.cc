// Replica as rendered for iMAP and NICE-SLAM: results/frameNNNNNN.jpg, results/depthNNNNNN.png
// (16-bit), traj.txt (line k has the 16 numbers of T_W_C of frame k) and cam_params.json in the
// folder or beside it ({"camera": {"w", "h", "fx", "fy", "cx", "cy", "scale"}}, scale = depth steps
// per metre). Frames count from 0; 30 frames per second.
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

bool LooksLikeReplica(const fs::path& folder) {
  return fs::is_directory(folder / "results") && fs::exists(folder / "traj.txt");
}

struct ReplicaCamera {
  PinholeCamera camera;
  double scale = 0;
  std::string path;
};

Result<ReplicaCamera> ReadReplicaCamera(const fs::path& folder) {
  fs::path path = folder / "cam_params.json";
  if (!fs::exists(path)) path = folder.parent_path() / "cam_params.json";
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  const Result<nlohmann::json> parsed = ParseJson(*text);
  if (!parsed) return Fail(path.string() + ": " + parsed.error().message);
  const nlohmann::json& root = *parsed;
  const auto camera = root.is_object() ? root.find("camera") : root.end();
  if (!root.is_object() || camera == root.end() || !camera->is_object()) {
    return Fail(path.string() +
                ": expected a JSON object {\"camera\": {...}}, but the file has none");
  }
  for (const char* key : {"w", "h", "fx", "fy", "cx", "cy", "scale"}) {
    const auto value = camera->find(key);
    if (value == camera->end() || !value->is_number() || std::abs(value->get<double>()) > 1e6) {
      return Fail(path.string() + ": camera." + key + ": expected a number, found " +
                  (value == camera->end() ? "no such key" : DescribeJson(*value)));
    }
  }
  const double scale = (*camera)["scale"].get<double>();
  if (!(scale >= 1)) {
    return Fail(path.string() + ": camera.scale is " + std::to_string(scale) +
                "; expected 1 or more depth steps per metre");
  }
  return ReplicaCamera{
      {(*camera)["w"].get<int>(), (*camera)["h"].get<int>(), (*camera)["fx"].get<double>(),
       (*camera)["fy"].get<double>(), (*camera)["cx"].get<double>(), (*camera)["cy"].get<double>()},
      scale,
      path.string()};
}

Result<void> SetReplicaPoses(const fs::path& path, std::vector<FrameFiles>* frames) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::vector<Result<Pose>> poses;
  for (const TextLine& line : SplitLines(*text)) {
    std::vector<double> numbers;
    for (const std::string_view word : line.words) {
      if (const auto number = ParseNumber(word)) numbers.push_back(*number);
    }
    if (line.words.size() != 16 || numbers.size() != 16) {
      return FailAtLine(path, line, "16 numbers");
    }
    poses.push_back(MakePose(RowMajor4x4(numbers.data())));
  }
  for (FrameFiles& frame : *frames) {
    const auto line = static_cast<size_t>(frame.number);
    frame.T_W_C = line < poses.size()
                      ? poses[line]
                      : Fail("traj.txt has only " + std::to_string(poses.size()) + " poses");
  }
  return {};
}

Result<SequenceFiles> ListReplica(const fs::path& folder) {
  const Result<ReplicaCamera> parameters = ReadReplicaCamera(folder);
  if (!parameters) return Fail(parameters.error().message);
  Result<std::vector<FrameFiles>> frames = PairByNumber(
      {folder / "results", "frame", {".jpg", ".png"}}, {folder / "results", "depth", {".png"}});
  if (!frames) return Fail(frames.error().message);
  if (const auto set = SetReplicaPoses(folder / "traj.txt", &*frames); !set) {
    return Fail(set.error().message);
  }
  for (FrameFiles& frame : *frames) frame.utime = UtimeAtRate(frame.number, kUsualRate);
  SequenceFiles files;
  files.known_camera = KnownCamera{parameters->camera, parameters->path, false};
  files.depth_unit_m = 1 / parameters->scale;
  files.depth_unit_source = parameters->path;
  files.frames = std::move(*frames);
  return files;
}

}  // namespace

const DatasetFormat kReplicaFormat{"replica", "results/ and traj.txt", LooksLikeReplica,
                                   ListReplica};

}  // namespace vismap
