#include "plausibility/pose_hypotheses.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <utility>

namespace vismap {
namespace {

using PoseMap = std::function<Pose(const Pose&)>;

Pose Rotation(const Eigen::Matrix3d& matrix) {
  Pose pose = Pose::Identity();
  pose.linear() = matrix;
  return pose;
}

// Coordinates of the optical frame (x right, y down, z forward) in OpenGL's camera (x right, y up,
// z backward).
Pose FromOpenGl() { return Rotation(Eigen::Vector3d(1, -1, -1).asDiagonal()); }

// The same in a robot's body (x forward, y left, z up).
Pose FromBody() {
  Eigen::Matrix3d matrix;
  matrix << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Rotation(matrix);
}

Pose WithTranslation(Pose pose, double factor) {
  pose.translation() *= factor;
  return pose;
}

// The four numbers of the quaternion were read as (x, y, z, w), but are `order` of them.
Pose WithQuaternion(const Pose& pose, const std::array<int, 4>& order) {
  const Eigen::Quaterniond read(pose.linear());
  const Eigen::Vector4d fields = read.coeffs();  // x, y, z, w as they stood in the file
  Pose other = pose;
  other.linear() =
      Eigen::Quaterniond(fields[order[3]], fields[order[0]], fields[order[1]], fields[order[2]])
          .normalized()
          .toRotationMatrix();
  return other;
}

std::vector<std::pair<std::string, PoseMap>> PoseMaps() {
  const std::string unit =
      "translations and depth are in different units: they agree when the "
      "translations are divided by ";
  std::vector<std::pair<std::string, PoseMap>> maps{
      {"the poses are world-to-camera, not camera-to-world",
       [](const Pose& T) { return T.inverse(); }},
      {"the camera axes are those of OpenGL (y up, z backward)",
       [](const Pose& T) { return T * FromOpenGl(); }},
      {"the poses are world-to-camera with the camera axes of OpenGL (y up, z backward)",
       [](const Pose& T) { return T.inverse() * FromOpenGl(); }},
      {"the poses are those of a body (x forward, y left, z up), not of the camera's optical frame",
       [](const Pose& T) { return T * FromBody(); }},
      {"the quaternions are in the order w x y z, not x y z w",
       [](const Pose& T) {
         return WithQuaternion(T, {1, 2, 3, 0});
       }},
  };
  for (const double factor : {1000.0, 100.0, 10.0, 5.0, 0.2, 0.1}) {
    const bool whole = factor >= 1;
    maps.emplace_back(whole ? unit + std::to_string(static_cast<int>(factor))
                            : "translations and depth are in different units: they agree when the "
                              "translations are multiplied by " +
                                  std::to_string(static_cast<int>(1 / factor + 0.5)),
                      [factor](const Pose& T) { return WithTranslation(T, 1 / factor); });
  }
  return maps;
}

}  // namespace

std::vector<PoseHypothesis> PoseHypotheses(const PosesByIndex& known, size_t frames,
                                           const std::vector<size_t>& chosen) {
  std::vector<PoseHypothesis> hypotheses;
  for (const auto& [sentence, map] : PoseMaps()) {
    PoseHypothesis& hypothesis = hypotheses.emplace_back(PoseHypothesis{sentence, {}});
    for (const size_t i : chosen) hypothesis.T_W_C.push_back(map(known.at(i)));
  }
  const auto last = static_cast<int64_t>(frames) - 1;
  for (const int64_t shift : {-1, 1, -2, 2, -3, 3, -5, 5, -10, 10, -20, 20}) {
    if (4 * std::abs(shift) > last)
      continue;  // most frames would get the pose of the first or last
    const std::string count = std::to_string(shift > 0 ? shift : -shift);
    PoseHypothesis& hypothesis = hypotheses.emplace_back(PoseHypothesis{
        "the times of poses and images are off: they agree when every image gets the pose of " +
            count + (shift > 0 ? " frames later" : " frames earlier"),
        {}});
    for (const size_t i : chosen)
      hypothesis.T_W_C.push_back(known.at(
          static_cast<size_t>(std::clamp<int64_t>(static_cast<int64_t>(i) + shift, 0, last))));
  }
  return hypotheses;
}

}  // namespace vismap
