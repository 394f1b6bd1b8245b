#include "wire/pose_correction.h"

#include <algorithm>
#include <string>

namespace vismap {

namespace {
using RowMajorPose = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
}  // namespace

pose_correction_t Encode(const PoseCorrection& correction) {
  pose_correction_t message{};
  message.camera_id = Raw(correction.camera_id);
  message.mode = correction.interpolated ? pose_correction_t::MODE_INTERPOLATED
                                         : pose_correction_t::MODE_EXACT;
  for (const PoseAtTime& pose : correction.poses) {
    corrected_pose_t corrected{};
    corrected.utime = pose.utime;
    Eigen::Map<RowMajorPose>(corrected.T_W_C) = pose.T_W_C.matrix();
    message.poses.push_back(corrected);
  }
  message.n_poses = static_cast<int32_t>(message.poses.size());
  return message;
}

Result<PoseCorrection> Decode(const pose_correction_t& message) {
  if (message.camera_id < 0)
    return Fail("camera_id: expected 0 or more, found " + std::to_string(message.camera_id));
  if (message.mode != pose_correction_t::MODE_EXACT &&
      message.mode != pose_correction_t::MODE_INTERPOLATED)
    return Fail("mode: expected 0 or 1, found " + std::to_string(message.mode));
  if (message.n_poses < 1 || message.n_poses > kMaxCorrectedPoses)
    return Fail("n_poses: expected 1 to " + std::to_string(kMaxCorrectedPoses) + ", found " +
                std::to_string(message.n_poses));
  PoseCorrection correction{
      CameraId{message.camera_id}, message.mode == pose_correction_t::MODE_INTERPOLATED, {}};
  for (const corrected_pose_t& corrected : message.poses) {
    const Result<Pose> pose = MakePose(Eigen::Map<const RowMajorPose>(corrected.T_W_C));
    if (!pose) {
      return Fail("the pose of utime " + std::to_string(corrected.utime) +
                  " cannot be used: " + pose.error().message);
    }
    correction.poses.push_back({corrected.utime, *pose});
  }
  std::vector<PoseAtTime>& poses = correction.poses;
  std::stable_sort(poses.begin(), poses.end(),
                   [](const PoseAtTime& a, const PoseAtTime& b) { return a.utime < b.utime; });
  const auto twice = std::adjacent_find(
      poses.begin(), poses.end(),
      [](const PoseAtTime& a, const PoseAtTime& b) { return a.utime == b.utime; });
  if (twice != poses.end())
    return Fail("there are two poses for utime " + std::to_string(twice->utime));
  return correction;
}

}  // namespace vismap
