#include "simulation/shape.h"

#include <algorithm>
#include <cmath>

namespace vismap {
namespace {

using Eigen::Vector3d;

double EnterBox(const Vector3d& half, const Vector3d& o, const Vector3d& d) {
  double enter = 0, leave = kNoHit;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (std::abs(o[i]) > half[i]) return kNoHit;
      continue;
    }
    const double a = (-half[i] - o[i]) / d[i];
    const double b = (half[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter > 0 && enter <= leave ? enter : kNoHit;
}

double EnterEllipsoid(const Vector3d& radii, const Vector3d& o, const Vector3d& d) {
  const Vector3d p = o.cwiseQuotient(radii);
  const Vector3d q = d.cwiseQuotient(radii);
  const double a = q.squaredNorm(), b = p.dot(q), c = p.squaredNorm() - 1;
  const double root = b * b - a * c;
  if (root < 0 || b >= 0 || c <= 0) return kNoHit;  // the ray misses, points away, or starts inside
  return c / (-b + std::sqrt(root));  // the smaller root, computed without cancellation
}

double EnterCylinder(const Vector3d& half, const Vector3d& o, const Vector3d& d) {
  double enter = 0, leave = kNoHit;
  if (d.z() == 0) {
    if (std::abs(o.z()) > half.z()) return kNoHit;
  } else {
    const double a = (-half.z() - o.z()) / d.z();
    const double b = (half.z() - o.z()) / d.z();
    enter = std::max(0.0, std::min(a, b));
    leave = std::max(a, b);
  }
  const double a = d.head<2>().squaredNorm(), b = o.head<2>().dot(d.head<2>());
  const double c = o.head<2>().squaredNorm() - half.x() * half.x();
  if (a == 0) return c <= 0 && enter > 0 && enter <= leave ? enter : kNoHit;
  const double root = b * b - a * c;
  if (root < 0) return kNoHit;
  enter = std::max(enter, (-b - std::sqrt(root)) / a);
  leave = std::min(leave, (-b + std::sqrt(root)) / a);
  return enter > 0 && enter <= leave ? enter : kNoHit;
}

double BoxDistance(const Vector3d& half, const Vector3d& p) {
  const Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

double CylinderDistance(const Vector3d& half, const Vector3d& p) {
  const Eigen::Vector2d q(p.head<2>().norm() - half.x(), std::abs(p.z()) - half.z());
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// The signed distance to an ellipsoid, after Eberly, "Distance from a point to an ellipse, an
/// ellipsoid". The foot point is r^2 p / (t + r^2), where t > -r_min^2 is the value that puts it on
/// the surface. The equation is solved by bisection for s = t + r_min^2, which avoids cancellation
/// near the centre.
double EllipsoidDistance(const Vector3d& r, const Vector3d& p_signed) {
  constexpr double kOffAxis = 1e-10;  // on a symmetry plane, the foot point is not unique
  const Vector3d p = p_signed.cwiseAbs().cwiseMax(kOffAxis);
  const Vector3d r2 = r.cwiseProduct(r);
  const Vector3d above = r2 - Vector3d::Constant(r2.minCoeff());
  const auto foot = [&](double s) -> Vector3d {
    return r2.cwiseProduct(p).cwiseQuotient(above + Vector3d::Constant(s));
  };
  double low = 0;
  double high = r.cwiseProduct(p).norm();
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (foot(middle).cwiseQuotient(r).squaredNorm() > 1 ? low : high) = middle;
  }
  const double distance = (p - foot(high)).norm();
  return p.cwiseQuotient(r).squaredNorm() > 1 ? distance : -distance;
}

}  // namespace

double EnterSolid(const Shape& shape, const Vector3d& origin_O, const Vector3d& direction_O) {
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return EnterBox(shape.half_size, origin_O, direction_O);
    case Shape::Kind::kEllipsoid:
      return EnterEllipsoid(shape.half_size, origin_O, direction_O);
    case Shape::Kind::kCylinder:
      return EnterCylinder(shape.half_size, origin_O, direction_O);
  }
  return kNoHit;
}

Vector3d OutwardNormal(const Shape& shape, const Vector3d& p_O) {
  const Vector3d scaled = p_O.cwiseQuotient(shape.half_size);
  if (shape.kind == Shape::Kind::kEllipsoid)
    return scaled.cwiseQuotient(shape.half_size).normalized();
  Vector3d side = scaled.cwiseAbs();
  if (shape.kind == Shape::Kind::kCylinder) {
    const double radial = scaled.head<2>().norm();
    if (radial > side.z()) return Vector3d(p_O.x(), p_O.y(), 0).normalized();
    side.head<2>().setZero();
  }
  int axis = 0;
  side.maxCoeff(&axis);
  return Vector3d::Unit(axis) * (p_O[axis] < 0 ? -1 : 1);
}

double SignedDistance(const Shape& shape, const Vector3d& p_W) {
  const Vector3d p_O = shape.T_W_O.inverse() * p_W;
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return BoxDistance(shape.half_size, p_O);
    case Shape::Kind::kEllipsoid:
      return EllipsoidDistance(shape.half_size, p_O);
    case Shape::Kind::kCylinder:
      return CylinderDistance(shape.half_size, p_O);
  }
  return kNoHit;
}

Eigen::AlignedBox3d BoundingBox(const Shape& shape) {
  const Eigen::Matrix3d& R = shape.T_W_O.linear();
  const Vector3d& half = shape.half_size;
  Vector3d reach;
  for (int i = 0; i < 3; ++i) {
    const Vector3d row = R.row(i).transpose().cwiseProduct(half);
    switch (shape.kind) {
      case Shape::Kind::kBox:
        reach[i] = row.cwiseAbs().sum();
        break;
      case Shape::Kind::kEllipsoid:
        reach[i] = row.norm();
        break;
      case Shape::Kind::kCylinder:
        reach[i] = row.head<2>().norm() + std::abs(row.z());
        break;
    }
  }
  const Vector3d center = shape.T_W_O.translation();
  return {center - reach, center + reach};
}

}  // namespace vismap
