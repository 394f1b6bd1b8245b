// TUM RGB-D: rgb.txt and depth.txt (lines "time file"), or associations.txt (lines "time file time
// file"), and groundtruth.txt (lines "time tx ty tz qx qy qz qw", T_W_C). Depth has 5000 steps per
// metre, times are in seconds. Frames are numbered from 0 in the order of depth.txt or
// associations.txt. ICL-NUIM in TUM's layout: associations.txt and one *.gt.freiburg. Its times are
// frame numbers; 30 frames per second. Both formats use the intrinsics of camera.txt ("fx fy cx
// cy") if it exists.
#include <algorithm>
#include <cmath>
#include <set>

#include "datasets/formats.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxTimeDifference = 0.02;  // [s], as the tools of the benchmark
constexpr size_t kMaxCandidates = 64;
constexpr double kMaxPoseGap = 0.1;  // [s] between samples that are interpolated
constexpr double kIclRate = 30;

struct TimedFile {
  double time = 0;  ///< as in the file: seconds, or the frame number for ICL
  fs::path path;
};

struct TimedPair {
  TimedFile color, depth;
};

struct TimedPose {
  double time = 0;
  Result<Pose> T_W_C = Pose::Identity();
};

// Seconds whose microseconds a message can hold.
Result<void> CheckTime(double time, const fs::path& path, const TextLine& line,
                       std::string_view word) {
  constexpr double kMaxTime = 9e12;
  if (std::abs(time) <= kMaxTime) return {};
  return Fail(path.string() + ":" + std::to_string(line.number) + ": the time " +
              std::string(word.substr(0, 40)) +
              " is out of range; expected seconds (is it in nanoseconds?)");
}

Result<std::vector<TimedFile>> ReadList(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::vector<TimedFile> files;
  for (const TextLine& line : SplitLines(*text)) {
    const auto time = ParseNumber(line.words[0]);
    if (line.words.size() != 2 || !time || !std::isfinite(*time)) {
      return FailAtLine(path, line, "\"TIME FILE\"");
    }
    if (const auto checked = CheckTime(*time, path, line, line.words[0]); !checked)
      return tl::unexpected(checked.error());
    files.push_back({*time, path.parent_path() / line.words[1]});
  }
  if (files.empty()) return Fail(path.string() + ": expected lines \"TIME FILE\", found none");
  return files;
}

/// Parses a line of associations.txt. The depth file is the one whose path contains "depth",
/// because TUM lists colour first and ICL depth first.
Result<TimedPair> ParseAssociation(const fs::path& path, const TextLine& line) {
  if (line.words.size() != 4) return FailAtLine(path, line, "\"TIME FILE TIME FILE\"");
  std::array<TimedFile, 2> files;
  std::array<bool, 2> is_depth{};
  for (size_t i = 0; i < 2; ++i) {
    const auto time = ParseNumber(line.words[2 * i]);
    if (!time || !std::isfinite(*time)) return FailAtLine(path, line, "\"TIME FILE TIME FILE\"");
    if (const auto checked = CheckTime(*time, path, line, line.words[2 * i]); !checked)
      return tl::unexpected(checked.error());
    files[i] = {*time, path.parent_path() / line.words[2 * i + 1]};
    is_depth[i] = line.words[2 * i + 1].find("depth") != std::string_view::npos;
  }
  if (is_depth[0] == is_depth[1]) {
    return FailAtLine(path, line, "exactly one path with \"depth\" in it");
  }
  return is_depth[0] ? TimedPair{files[1], files[0]} : TimedPair{files[0], files[1]};
}

Result<std::vector<TimedPair>> ReadAssociations(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::vector<TimedPair> pairs;
  for (const TextLine& line : SplitLines(*text)) {
    const Result<TimedPair> pair = ParseAssociation(path, line);
    if (!pair) return Fail(pair.error().message);
    pairs.push_back(*pair);
  }
  if (pairs.empty())
    return Fail(path.string() + ": expected lines \"TIME FILE TIME FILE\", found none");
  return pairs;
}

/// Pairs colour and depth files by time, like associate.py of the benchmark: the closest pairs
/// first, each file at most once. Depth images without a partner get an empty colour path.
std::vector<TimedPair> Associate(std::vector<TimedFile> colors, std::vector<TimedFile> depths) {
  const auto by_time = [](const TimedFile& a, const TimedFile& b) { return a.time < b.time; };
  std::stable_sort(colors.begin(), colors.end(), by_time);
  std::stable_sort(depths.begin(), depths.end(), by_time);
  // A recorder may write a line twice. Of several files with one time the first one is used.
  const auto same_time = [](const TimedFile& a, const TimedFile& b) { return a.time == b.time; };
  colors.erase(std::unique(colors.begin(), colors.end(), same_time), colors.end());
  depths.erase(std::unique(depths.begin(), depths.end(), same_time), depths.end());
  std::vector<std::tuple<double, size_t, size_t>> candidates;
  size_t begin = 0;
  for (size_t d = 0; d < depths.size(); ++d) {
    while (begin < colors.size() && colors[begin].time < depths[d].time - kMaxTimeDifference) {
      ++begin;
    }
    // Cameras take a few images in this time; more are not compared, so that no list takes long.
    for (size_t c = begin; c < std::min(begin + kMaxCandidates, colors.size()); ++c) {
      if (colors[c].time > depths[d].time + kMaxTimeDifference) break;
      candidates.emplace_back(std::abs(colors[c].time - depths[d].time), d, c);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<TimedPair> pairs(depths.size());
  for (size_t d = 0; d < depths.size(); ++d) pairs[d].depth = depths[d];
  std::vector<bool> color_used(colors.size(), false);
  for (const auto& [difference, d, c] : candidates) {
    if (color_used[c] || !pairs[d].color.path.empty()) continue;  // one of them has a partner
    pairs[d].color = colors[c];
    color_used[c] = true;
  }
  return pairs;
}

Result<Pose> PoseOf(const std::vector<double>& n) {
  const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
  // The files have 4 digits. A quaternion that is farther from unit length is not a rotation.
  if (!(std::abs(q.norm() - 1) < 0.01)) {
    return Fail("the quaternion has length " + std::to_string(q.norm()) + "; expected 1");
  }
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = q.normalized().toRotationMatrix();
  matrix.topRightCorner<3, 1>() << n[1], n[2], n[3];
  return MakePose(matrix);
}

/// Reads the poses of a file, sorted by time.
Result<std::vector<TimedPose>> ReadPoses(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  std::vector<TimedPose> poses;
  for (const TextLine& line : SplitLines(*text)) {
    std::vector<double> numbers;
    for (const std::string_view word : line.words) {
      if (const auto number = ParseNumber(word)) numbers.push_back(*number);
    }
    if (line.words.size() != 8 || numbers.size() != 8 || !std::isfinite(numbers[0])) {
      return FailAtLine(path, line, "\"TIME TX TY TZ QX QY QZ QW\"");
    }
    if (const auto checked = CheckTime(numbers[0], path, line, line.words[0]); !checked)
      return tl::unexpected(checked.error());
    poses.push_back({numbers[0], PoseOf(numbers)});
  }
  if (poses.empty()) {
    return Fail(path.string() + ": expected lines \"TIME TX TY TZ QX QY QZ QW\", found no poses");
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
  return poses;
}

// The pose between two samples: translations are interpolated linearly, rotations on the shortest
// arc.
Pose Interpolate(const TimedPose& before, const TimedPose& after, double time) {
  const double share = (time - before.time) / (after.time - before.time);
  const Eigen::Quaterniond from(before.T_W_C->linear()), to(after.T_W_C->linear());
  Pose pose = Pose::Identity();
  pose.linear() = from.slerp(share, to).toRotationMatrix();
  pose.translation() =
      (1 - share) * before.T_W_C->translation() + share * after.T_W_C->translation();
  return pose;
}

// The pose at a time: that of a sample at this time, else interpolated between two samples that are
// at most kMaxPoseGap apart, else that of the nearest sample within `max_difference`.
Result<Pose> PoseAt(const std::vector<TimedPose>& poses, double time, double max_difference) {
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), time,
                       [](const TimedPose& pose, double at) { return pose.time < at; });
  if (after != poses.end() && after->time == time) return after->T_W_C;
  auto nearest = after == poses.end() ? after - 1 : after;
  if (nearest != poses.begin() && time - (nearest - 1)->time < std::abs(nearest->time - time)) {
    --nearest;
  }
  if (max_difference > 0 && after != poses.end() && after != poses.begin()) {
    const TimedPose& before = *(after - 1);
    if (after->time - before.time <= kMaxPoseGap && before.T_W_C && after->T_W_C)
      return Interpolate(before, *after, time);
  }
  const double difference = std::abs(nearest->time - time);
  if (difference <= max_difference) return nearest->T_W_C;
  return Fail("there is no pose at time " + std::to_string(time) + "; the nearest one is at time " +
              std::to_string(nearest->time));
}

// The intrinsics of a sequence and its depth steps per metre.
struct Calibration {
  Result<KnownCamera> camera = Fail("the intrinsics are unknown");
  double steps_per_metre = 5000;
  std::string steps_source = "the format";
};

// camera.txt: "fx fy cx cy", and optionally the depth steps per metre.
Result<Calibration> ReadCameraFile(const fs::path& path) {
  Result<std::vector<double>> n = ReadNumbers(path, 4);
  if (!n) n = ReadNumbers(path, 5);
  if (!n) {
    return Fail(path.string() +
                ": expected four numbers \"fx fy cx cy\", or five with the depth steps per metre");
  }
  Calibration calibration;
  calibration.camera = KnownCamera{
      {.fx = (*n)[0], .fy = (*n)[1], .cx = (*n)[2], .cy = (*n)[3]}, path.string(), false};
  if (n->size() == 4) return calibration;
  calibration.steps_per_metre = (*n)[4];
  calibration.steps_source = path.string();
  if ((*n)[4] >= 1 && (*n)[4] <= 1e6) return calibration;
  return Fail(path.string() + ": the fifth number is " + std::to_string((*n)[4]) +
              "; expected depth steps per metre, 1 to 1000000");
}

bool Contains(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// The intrinsics that the benchmark recommends: the ROS default for fr1 and fr2, whose images are
/// distorted, and the calibration for fr3, whose images are undistorted.
Result<Calibration> TumCalibration(const fs::path& folder) {
  if (fs::exists(folder / "camera.txt")) return ReadCameraFile(folder / "camera.txt");
  const std::string name = folder.filename().string();
  Calibration calibration;
  if (Contains(name, {"fr1", "freiburg1", "fr2", "freiburg2"})) {
    calibration.camera = KnownCamera{
        {640, 480, 525, 525, 319.5, 239.5}, "assumed for fr1 and fr2 of the TUM benchmark", true};
  } else if (Contains(name, {"fr3", "freiburg3"})) {
    calibration.camera = KnownCamera{
        {640, 480, 535.4, 539.2, 320.1, 247.6}, "assumed for fr3 of the TUM benchmark", true};
  } else {
    calibration.camera = Fail(
        folder.string() +
        ": the intrinsics are unknown: the folder's name has none of fr1, fr2, fr3 and there is no "
        "camera.txt with \"fx fy cx cy\"; write one, or give --intrinsics fx,fy,cx,cy");
  }
  return calibration;
}

Result<Calibration> IclCalibration(const fs::path& folder) {
  if (fs::exists(folder / "camera.txt")) return ReadCameraFile(folder / "camera.txt");
  Calibration calibration;
  calibration.camera =
      KnownCamera{{640, 480, 481.2, -480, 319.5, 239.5}, "assumed for ICL-NUIM", true};
  return calibration;
}

std::vector<FrameFiles> MakeFrames(const std::vector<TimedPair>& pairs,
                                   const std::vector<TimedPose>& poses, double max_difference) {
  std::vector<FrameFiles> frames;
  for (const TimedPair& pair : pairs) {
    FrameFiles frame;
    frame.number = static_cast<int64_t>(frames.size());
    frame.utime = std::llround(pair.depth.time * 1e6);
    frame.color = pair.color.path;
    frame.depth = pair.depth.path;
    frame.T_W_C = pair.color.path.empty()
                      ? Fail("no colour image within 20 ms of " + pair.depth.path.string())
                      : PoseAt(poses, pair.depth.time, max_difference);
    frames.push_back(std::move(frame));
  }
  return frames;
}

Result<SequenceFiles> Finish(const Result<Calibration>& calibration,
                             std::vector<FrameFiles> frames) {
  if (!calibration) return tl::unexpected(calibration.error());
  SequenceFiles files;
  files.known_camera = calibration->camera;
  files.depth_unit_m = 1 / calibration->steps_per_metre;
  files.depth_unit_source = calibration->steps_source;
  files.frames = std::move(frames);
  return files;
}

Result<std::vector<TimedPair>> ListTumPairs(const fs::path& folder) {
  if (fs::exists(folder / "associations.txt")) return ReadAssociations(folder / "associations.txt");
  const Result<std::vector<TimedFile>> colors = ReadList(folder / "rgb.txt");
  if (!colors) return Fail(colors.error().message);
  const Result<std::vector<TimedFile>> depths = ReadList(folder / "depth.txt");
  if (!depths) return Fail(depths.error().message);
  return Associate(*colors, *depths);
}

Result<SequenceFiles> ListTum(const fs::path& folder) {
  const Result<std::vector<TimedPair>> pairs = ListTumPairs(folder);
  if (!pairs) return Fail(pairs.error().message);
  const Result<std::vector<TimedPose>> poses = ReadPoses(folder / "groundtruth.txt");
  if (!poses) return Fail(poses.error().message);
  Result<SequenceFiles> files =
      Finish(TumCalibration(folder), MakeFrames(*pairs, *poses, kMaxTimeDifference));
  if (files) files->has_clock = true;
  return files;
}

bool LooksLikeTum(const fs::path& folder) {
  return fs::exists(folder / "groundtruth.txt") &&
         (fs::exists(folder / "associations.txt") ||
          (fs::exists(folder / "rgb.txt") && fs::exists(folder / "depth.txt")));
}

Result<fs::path> FindFreiburg(const fs::path& folder) {
  std::set<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().string().ends_with(".gt.freiburg")) found.insert(entry.path());
  }
  if (found.size() == 1) return *found.begin();
  return Fail(folder.string() + ": expected one *.gt.freiburg, found " +
              std::to_string(found.size()));
}

Result<SequenceFiles> ListIcl(const fs::path& folder) {
  const Result<fs::path> poses_path = FindFreiburg(folder);
  if (!poses_path) return Fail(poses_path.error().message);
  const Result<std::vector<TimedPair>> pairs = ReadAssociations(folder / "associations.txt");
  if (!pairs) return Fail(pairs.error().message);
  const Result<std::vector<TimedPose>> poses = ReadPoses(*poses_path);
  if (!poses) return Fail(poses.error().message);
  std::vector<FrameFiles> frames = MakeFrames(*pairs, *poses, 0);
  for (FrameFiles& frame : frames) {
    const auto number = NumberInName(frame.depth.filename().string(), "", ".png");
    if (!number) return Fail(frame.depth.string() + ": expected a number as file name");
    frame.number = *number;
    frame.utime = UtimeAtRate(*number, kIclRate);
  }
  return Finish(IclCalibration(folder), std::move(frames));
}

bool LooksLikeIcl(const fs::path& folder) {
  return fs::exists(folder / "associations.txt") && FindFreiburg(folder).has_value();
}

}  // namespace

const DatasetFormat kTumFormat{"tum", "groundtruth.txt with associations.txt or rgb.txt, depth.txt",
                               LooksLikeTum, ListTum};
const DatasetFormat kIclFormat{"icl", "associations.txt with one *.gt.freiburg", LooksLikeIcl,
                               ListIcl};

}  // namespace vismap
