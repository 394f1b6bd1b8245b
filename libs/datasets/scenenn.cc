// SceneNN as its tools extract it: image/imageNNNNN.png and depth/depthNNNNN.png (16-bit, mm), both
// counted from 1; trajectory.log, in which image k has the pose of index k - 1; intrinsic/asus.ini
// in the folder or beside it; and optionally timestamp.txt (lines "k utime"). Our exports add the
// key depth_unit_m to asus.ini if depth is not in mm.
#include <map>

#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

struct Ini {
  PinholeCamera camera;
  double rate = 30;  ///< frames per second
  double depth_unit_m = 0.001;
  bool states_depth_unit = false;
};

bool LooksLikeSceneNn(const fs::path& folder) {
  return fs::is_directory(folder / "image") && fs::is_directory(folder / "depth") &&
         fs::exists(folder / "trajectory.log");
}

Result<fs::path> FindIni(const fs::path& folder) {
  for (const fs::path& place : {folder, folder.parent_path()}) {
    if (fs::exists(place / "intrinsic" / "asus.ini")) return place / "intrinsic" / "asus.ini";
  }
  return Fail(folder.string() +
              ": expected intrinsic/asus.ini in the folder or beside it, found none");
}

Result<Ini> ReadIni(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::map<std::string_view, double> values;
  for (const TextLine& line : SplitLines(*text)) {
    const std::optional<double> number = ParseNumber(line.words.back());
    if (number) values[line.words.front()] = *number;
  }
  for (const char* key : {"depth_width", "depth_height", "fx", "fy", "cx", "cy"}) {
    if (!values.contains(key)) {
      return Fail(path.string() + ": expected a line \"" + key + " NUMBER\", found none");
    }
  }
  Ini ini;
  ini.camera = {static_cast<int>(values["depth_width"]),
                static_cast<int>(values["depth_height"]),
                values["fx"],
                values["fy"],
                values["cx"],
                values["cy"]};
  if (values.contains("depth_fps")) ini.rate = values["depth_fps"];
  if (!(ini.rate >= 0.1 && ini.rate < 1e4)) {
    return Fail(path.string() + ": depth_fps is " + std::to_string(ini.rate) +
                "; expected frames per second, at least 0.1 and below 10000");
  }
  ini.states_depth_unit = values.contains("depth_unit_m");
  if (ini.states_depth_unit) ini.depth_unit_m = values["depth_unit_m"];
  if (!(ini.depth_unit_m > 0 && ini.depth_unit_m <= 1)) {
    return Fail(path.string() + ": depth_unit_m is " + std::to_string(ini.depth_unit_m) +
                "; expected metres in (0, 1]");
  }
  return ini;
}

using Timestamps = std::map<int64_t, int64_t>;

Result<Timestamps> ReadTimestamps(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  Timestamps utimes;
  for (const TextLine& line : SplitLines(*text)) {
    const auto number = ParseInteger(line.words.front());
    const auto utime = ParseInteger(line.words.back());
    if (line.words.size() != 2 || !number || !utime) {
      return FailAtLine(path, line, "\"IMAGE_NUMBER UTIME\"");
    }
    utimes[*number] = *utime;
  }
  return utimes;
}

Result<void> SetTimes(const fs::path& folder, double rate, std::vector<FrameFiles>* frames) {
  const fs::path path = folder / "timestamp.txt";
  if (!fs::exists(path)) {
    for (FrameFiles& frame : *frames) frame.utime = UtimeAtRate(frame.number, rate);
    return {};
  }
  const Result<Timestamps> utimes = ReadTimestamps(path);
  if (!utimes) return Fail(utimes.error().message);
  for (FrameFiles& frame : *frames) {
    const auto found = utimes->find(frame.number);
    if (found == utimes->end()) {
      frame.missing = "timestamp.txt has no line for image " + std::to_string(frame.number);
      continue;
    }
    frame.utime = found->second;
  }
  return {};
}

Result<void> SetLoggedPoses(const fs::path& path, std::vector<FrameFiles>* frames) {
  const Result<std::vector<LoggedPose>> log = ReadTrajectoryLog(path);
  if (!log) return Fail(log.error().message);
  std::map<int64_t, const Result<Pose>*> poses;
  for (const LoggedPose& pose : *log) {
    if (!poses.emplace(pose.index, &pose.T_W_C).second) {
      return Fail(path.string() + ": expected one pose per index, found two poses of index " +
                  std::to_string(pose.index));
    }
  }
  for (FrameFiles& frame : *frames) {
    const auto found = poses.find(frame.number - 1);
    frame.T_W_C =
        found != poses.end()
            ? *found->second
            : Fail("trajectory.log has no pose of index " + std::to_string(frame.number - 1));
  }
  return {};
}

Result<SequenceFiles> ListSceneNn(const fs::path& folder) {
  const Result<fs::path> ini_path = FindIni(folder);
  if (!ini_path) return Fail(ini_path.error().message);
  const Result<Ini> ini = ReadIni(*ini_path);
  if (!ini) return Fail(ini.error().message);
  Result<std::vector<FrameFiles>> frames = PairByNumber(
      {folder / "image", "image", {".png", ".jpg"}}, {folder / "depth", "depth", {".png"}});
  if (!frames) return Fail(frames.error().message);
  if (const auto set = SetTimes(folder, ini->rate, &*frames); !set)
    return Fail(set.error().message);
  if (const auto set = SetLoggedPoses(folder / "trajectory.log", &*frames); !set) {
    return Fail(set.error().message);
  }
  SequenceFiles files;
  files.known_camera = KnownCamera{ini->camera, ini_path->string(), false};
  files.depth_unit_m = ini->depth_unit_m;
  if (ini->states_depth_unit) files.depth_unit_source = ini_path->string();
  files.has_clock = fs::exists(folder / "timestamp.txt");
  files.frames = std::move(*frames);
  return files;
}

}  // namespace

const DatasetFormat kSceneNnFormat{"scenenn", "image/, depth/ and trajectory.log", LooksLikeSceneNn,
                                   ListSceneNn};

}  // namespace vismap
