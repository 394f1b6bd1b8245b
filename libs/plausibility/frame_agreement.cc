#include "plausibility/frame_agreement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/require.h"

namespace vismap {
namespace {

constexpr double kTolerance = 0.02;          // [m]
constexpr double kRelativeTolerance = 0.06;  // of the distance
constexpr double kCloseTolerance = 0.015;    // of the distance
constexpr int64_t kJudgedPoints = 100;       // fewer say nothing about a frame
constexpr double kLeastAgreement = 0.6;

void CountPoint(const Eigen::Vector3d& p_C, const FrameSample& to, PointCounts* counts) {
  if (!(p_C.z() > 0.05)) return;  // behind the camera, or in it
  const Eigen::Vector2d pixel = to.header.camera.Project(p_C) / to.step;
  const double u = std::round(pixel.x()), v = std::round(pixel.y());
  if (!(u >= 0 && v >= 0 && u < to.depth.width() && v < to.depth.height())) return;
  const double nearest = to.nearest(static_cast<int>(v), static_cast<int>(u));
  const double farthest = to.farthest(static_cast<int>(v), static_cast<int>(u));
  if (!std::isfinite(nearest)) return;  // no return: the frame says nothing here
  const double close = kTolerance + kCloseTolerance * p_C.z();
  ++counts->in_view;
  if (p_C.z() >= nearest - close && p_C.z() <= farthest + close) ++counts->close;
  const double tolerance = kTolerance + kRelativeTolerance * p_C.z();
  if (p_C.z() < nearest - tolerance) {
    ++counts->seen_through;
  } else if (p_C.z() <= farthest + tolerance) {
    ++counts->agree;
  }
}

bool Moved(const Pose& a, const Pose& b) {
  const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
  return angle >= 5 * std::numbers::pi / 180 || (a.translation() - b.translation()).norm() >= 0.15;
}

}  // namespace

double PointCounts::Agreement() const {
  const int64_t judged = agree + seen_through;
  return judged > 0 ? static_cast<double>(agree) / static_cast<double>(judged) : 1.0;
}

double PointCounts::Closeness() const {
  return in_view > 0 ? static_cast<double>(close) / static_cast<double>(in_view) : 0.0;
}

PointCounts& PointCounts::operator+=(const PointCounts& other) {
  points += other.points;
  agree += other.agree;
  seen_through += other.seen_through;
  in_view += other.in_view;
  close += other.close;
  return *this;
}

PointCounts CompareFrames(const FrameSample& from, const Pose& T_W_C_from, const FrameSample& to,
                          const Pose& T_W_C_to) {
  const Pose T_to_from = T_W_C_to.inverse() * T_W_C_from;
  PointCounts counts;
  for (int v = 0; v < from.depth.height(); ++v) {
    for (int u = 0; u < from.depth.width(); ++u) {
      const float z = from.depth(v, u);
      if (!std::isfinite(z)) continue;
      ++counts.points;
      CountPoint(T_to_from * from.header.camera.BackProject(u * from.step, v * from.step, z), to,
                 &counts);
    }
  }
  return counts;
}

double AgreementSummary::ContradictingShare() const {
  int judged = 0, contradicting = 0;
  for (const PointCounts& counts : per_frame) {
    if (counts.agree + counts.seen_through < kJudgedPoints) continue;
    ++judged;
    if (counts.Agreement() < kLeastAgreement) ++contradicting;
  }
  return judged > 0 ? static_cast<double>(contradicting) / judged : 0;
}

AgreementSummary CompareAllFrames(const std::vector<FrameSample>& frames,
                                  const std::vector<Pose>& T_W_C) {
  Require(frames.size() == T_W_C.size(), "every frame has a pose");
  AgreementSummary summary;
  summary.per_frame.resize(frames.size());
  PointCounts couples;
  for (size_t i = 0; i < frames.size(); ++i) {
    for (size_t j = 0; j < frames.size(); ++j) {
      const bool couple = i % 2 == 0 && j == i + 1;
      if (i == j || (!couple && !Moved(T_W_C[i], T_W_C[j]))) continue;
      const PointCounts counts = CompareFrames(frames[i], T_W_C[i], frames[j], T_W_C[j]);
      if (couple) couples += counts;
      if (!Moved(T_W_C[i], T_W_C[j])) continue;
      summary.per_frame[i] += counts;
      summary.all += counts;
    }
  }
  if (couples.points > 0)
    summary.in_common = static_cast<double>(couples.agree) / static_cast<double>(couples.points);
  return summary;
}

}  // namespace vismap
