#include "rectify/lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace vismap {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kMaxRayAngle = 80 * std::numbers::pi / 180;
constexpr double kAngleStep = 0.002;  // of the search for the largest ray [rad]

// k1 k2 p1 p2 k3 k4 k5 k6 of Brown-Conrady, or k1 k2 k3 k4 of the fisheye; the missing ones are 0.
std::array<double, 8> CoefficientsOf(const LensCamera& lens) {
  std::array<double, 8> k{};
  std::copy_n(lens.coefficients.begin(), std::min<size_t>(8, lens.coefficients.size()), k.begin());
  return k;
}

double BrownRadial(const std::array<double, 8>& k, double r2) {
  return (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
}

Vector2d DistortBrown(const std::array<double, 8>& k, const Vector2d& ray) {
  const double x = ray.x(), y = ray.y(), r2 = ray.squaredNorm();
  const double radial = BrownRadial(k, r2);
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
          y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
}

// The distance from the principal point at which a fisheye shows a ray, in focal lengths.
double FisheyeRadius(const std::array<double, 8>& k, double angle) {
  const double a2 = angle * angle;
  return angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
}

Vector2d DistortFisheye(const std::array<double, 8>& k, const Vector2d& ray) {
  const double r = ray.norm();
  return r < 1e-12 ? ray : Vector2d(ray * (FisheyeRadius(k, std::atan(r)) / r));
}

// Distance from the principal point, in focal lengths, of a ray at this angle without the parts of
// the distortion that are not radial.
double RadiusAt(const LensCamera& lens, const std::array<double, 8>& k, double angle) {
  if (lens.distortion == Distortion::kEquidistant) return FisheyeRadius(k, angle);
  const double r = std::tan(angle);
  return lens.distortion == Distortion::kNone ? r : r * BrownRadial(k, r * r);
}

// The largest angle up to which RadiusAt grows.
double MaxAngle(const LensCamera& lens, double up_to) {
  const std::array<double, 8> k = CoefficientsOf(lens);
  double last = 0;
  for (double angle = kAngleStep; angle <= up_to; angle += kAngleStep) {
    const double radius = RadiusAt(lens, k, angle);
    if (!(radius > last)) return angle - kAngleStep;
    last = radius;
  }
  return up_to;
}

std::optional<Vector2d> UndistortBrown(const std::array<double, 8>& k, const Vector2d& target) {
  constexpr int kIterations = 30;
  constexpr double kDelta = 1e-6, kConverged = 1e-12;
  Vector2d ray = target;
  for (int i = 0; i < kIterations; ++i) {
    const Vector2d error = DistortBrown(k, ray) - target;
    Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = kDelta * Vector2d::Unit(axis);
      jacobian.col(axis) = (DistortBrown(k, ray + step) - DistortBrown(k, ray - step)) / 2 / kDelta;
    }
    const double det = jacobian.determinant();
    if (!(det > 1e-6) || !ray.allFinite()) return std::nullopt;
    if (error.squaredNorm() < kConverged * kConverged) return ray;
    ray -= jacobian.inverse() * error;
  }
  return (DistortBrown(k, ray) - target).norm() < 1e-8 ? std::optional(ray) : std::nullopt;
}

std::optional<Vector2d> UndistortFisheye(const std::array<double, 8>& k, const Vector2d& target) {
  const double radius = target.norm();
  if (radius < 1e-12) return target;
  double low = 0, high = kMaxRayAngle;
  if (!(FisheyeRadius(k, high) >= radius)) return std::nullopt;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (FisheyeRadius(k, middle) < radius ? low : high) = middle;
  }
  return Vector2d(target * (std::tan(0.5 * (low + high)) / radius));
}

Vector2d Normalised(const PinholeCamera& camera, const Vector2d& pixel) {
  return {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
}

Result<void> CheckCount(const LensCamera& lens) {
  const size_t count = lens.coefficients.size();
  const auto wrong = [&](const char* model, const char* expected) {
    return Fail(std::string(model) + " has " + std::to_string(count) + " coefficients; expected " +
                expected);
  };
  switch (lens.distortion) {
    case Distortion::kNone:
      if (count != 0) return wrong("a camera without distortion", "0");
      break;
    case Distortion::kBrownConrady:
      if (count != 4 && count != 5 && count != 8)
        return wrong("Brown-Conrady distortion", "4, 5 or 8");
      break;
    case Distortion::kEquidistant:
      if (count != 4) return wrong("equidistant distortion", "4");
      break;
    default:
      return Fail("distortion " + std::to_string(static_cast<int>(lens.distortion)) +
                  " is unknown; expected 0, 1 or 2");
  }
  for (const double k : lens.coefficients) {
    if (!std::isfinite(k))
      return Fail("a coefficient is " + std::to_string(k) + "; expected finite numbers");
  }
  return {};
}

// Every 16th part of width and height, with both borders.
template <typename Use>
void ForGrid(const PinholeCamera& camera, const Use& use) {
  constexpr int kParts = 16;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      use(Vector2d(-0.5 + camera.width * (double(j) / kParts),
                   -0.5 + camera.height * (double(i) / kParts)));
    }
  }
}

// A fisheye may see beyond what is used of it, so that only its growth is asked for.
bool FisheyeFolds(const LensCamera& lens) {
  const std::array<double, 8> k = CoefficientsOf(lens);
  double farthest = 0;
  ForGrid(lens.pinhole, [&](const Vector2d& pixel) {
    farthest = std::max(farthest, Normalised(lens.pinhole, pixel).norm());
  });
  const double angle = MaxAngle(lens, std::numbers::pi);
  return angle < std::numbers::pi && FisheyeRadius(k, angle) < farthest;
}

std::optional<Vector2d> FoldedPixel(const LensCamera& lens) {
  std::optional<Vector2d> folded;
  const double limit = MaxRayRadius(lens);
  ForGrid(lens.pinhole, [&](const Vector2d& pixel) {
    const std::optional<Vector2d> ray = Undistort(lens, pixel);
    if (!folded && (!ray || ray->norm() > limit)) folded = pixel;
  });
  return folded;
}

}  // namespace

Vector2d Distort(const LensCamera& lens, const Vector2d& ray) {
  const std::array<double, 8> k = CoefficientsOf(lens);
  const Vector2d p = lens.distortion == Distortion::kBrownConrady  ? DistortBrown(k, ray)
                     : lens.distortion == Distortion::kEquidistant ? DistortFisheye(k, ray)
                                                                   : ray;
  return {lens.pinhole.fx * p.x() + lens.pinhole.cx, lens.pinhole.fy * p.y() + lens.pinhole.cy};
}

std::optional<Vector2d> Undistort(const LensCamera& lens, const Vector2d& pixel) {
  const Vector2d target = Normalised(lens.pinhole, pixel);
  if (lens.distortion == Distortion::kNone) return target;
  const std::array<double, 8> k = CoefficientsOf(lens);
  if (lens.distortion == Distortion::kEquidistant) return UndistortFisheye(k, target);
  return UndistortBrown(k, target);
}

double MaxRayRadius(const LensCamera& lens) { return std::tan(MaxAngle(lens, kMaxRayAngle)); }

bool IsPinhole(const LensCamera& lens) {
  return lens.distortion == Distortion::kNone ||
         (lens.distortion == Distortion::kBrownConrady &&
          std::all_of(lens.coefficients.begin(), lens.coefficients.end(),
                      [](double k) { return k == 0; }));
}

Result<void> CheckLens(const LensCamera& lens) {
  if (const auto camera = ValidateCamera(lens.pinhole); !camera)
    return tl::unexpected(camera.error());
  return CheckCount(lens);
}

Result<void> CheckOneToOne(const LensCamera& lens) {
  if (IsPinhole(lens)) return {};
  const std::string folds = "the distortion folds within the image";
  const std::string expected =
      "; expected coefficients that give every pixel one ray, for an image of " +
      std::to_string(lens.pinhole.width) + "x" + std::to_string(lens.pinhole.height);
  if (lens.distortion == Distortion::kEquidistant) {
    if (FisheyeFolds(lens)) return Fail(folds + expected);
  } else if (const std::optional<Vector2d> pixel = FoldedPixel(lens)) {
    return Fail(folds + " near pixel (" + std::to_string(std::lround(pixel->x())) + ", " +
                std::to_string(std::lround(pixel->y())) + ")" + expected);
  }
  return {};
}

}  // namespace vismap
