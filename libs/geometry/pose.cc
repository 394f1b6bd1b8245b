#include "geometry/pose.h"

#include <Eigen/SVD>
#include <cmath>
#include <sstream>

namespace vismap {

Result<Pose> MakePose(const Eigen::Matrix4d& matrix) {
  if (!matrix.allFinite())
    return Fail("pose has a NaN or infinite entry; expected 16 finite numbers");
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-6) {
    std::ostringstream text;
    text << "pose has last row [" << matrix.row(3) << "]; expected [0 0 0 1]";
    if ((matrix.col(3) - Eigen::Vector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < 1e-6)
      text << "; is the matrix written column by column?";
    return Fail(text.str());
  }
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-3 || R.determinant() < 0) {
    std::ostringstream text;
    text << "pose is not rigid: |R R^T - I| is " << off << " (at most 0.001), det R is "
         << R.determinant() << " (expected +1)";
    if (std::abs(R.determinant() + 1) < 1e-3) text << "; is it left-handed?";
    const double scale = std::cbrt(R.determinant());
    if (scale > 0 &&
        (R * R.transpose() / (scale * scale) - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
            1e-3)
      text << "; is it scaled?";
    return Fail(text.str());
  }
  if (matrix.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > 1e5) {
    return Fail("pose translation is beyond 1e5 m; are its units metres?");
  }
  Pose pose = Pose::Identity();
  pose.linear() = R;
  if (off > 1e-9) {  // a pose that is exact already stays as it is, however often it is sent
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
    pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  }
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

}  // namespace vismap
