#include "map_tool/pose_file.h"

#include <array>
#include <cmath>
#include <set>

#include "datasets/text_file.h"

namespace vismap {
namespace {

constexpr char kTumLine[] = "TIME tx ty tz qx qy qz qw, with a quaternion of length 1";
constexpr double kLatestTime = 1e12;  // [s]

std::optional<PoseAtTime> ParseTumLine(const TextLine& line) {
  std::array<double, 8> numbers{};
  if (line.words.size() != numbers.size()) return std::nullopt;
  for (size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = ParseNumber(line.words[i]);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers[i] = *number;
  }
  const Eigen::Quaterniond q(numbers[7], numbers[4], numbers[5], numbers[6]);
  if (std::abs(q.norm() - 1) > 0.01 || std::abs(numbers[0]) > kLatestTime) return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = q.normalized().toRotationMatrix();
  matrix.topRightCorner<3, 1>() << numbers[1], numbers[2], numbers[3];
  const Result<Pose> pose = MakePose(matrix);
  if (!pose) return std::nullopt;
  return PoseAtTime{std::llround(numbers[0] * 1e6), *pose};
}

}  // namespace

Result<std::vector<PoseAtTime>> ReadTumTrajectory(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<PoseAtTime> poses;
  std::set<int64_t> times;
  for (const TextLine& line : SplitLines(*text)) {
    const std::optional<PoseAtTime> pose = ParseTumLine(line);
    if (!pose) return FailAtLine(path, line, kTumLine);
    if (!times.insert(pose->utime).second)
      return FailAtLine(path, line, "a time that does not stand above");
    poses.push_back(*pose);
  }
  if (poses.empty()) return Fail(path.string() + ": there is no pose in it");
  return poses;
}

}  // namespace vismap
