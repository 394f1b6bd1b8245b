#pragma once

#include <utility>
#include <vector>

#include "simulation/scene.h"

namespace vismap {

/// A heading around z as (cosine, sine). The constants below are exact, while the results of
/// std::cos and std::sin differ between math libraries.
struct Heading {
  double c = 1;
  double s = 0;
};
inline constexpr Heading kAhead{1, 0}, kLittle{0.96, 0.28}, kLittleRight{0.96, -0.28},
    kMuch{0.8, 0.6}, kLeft{0, 1}, kRight{0, -1}, kBack{-1, 0};

/// The position and heading of an object in W: a frame with x along the heading and z up. [m]
struct Place {
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  Heading heading;

  /// The place whose position and heading relative to this one are `point` [m] and `turn`.
  Place At(const Eigen::Vector3d& point, const Heading& turn = kAhead) const {
    const auto& [c, s] = heading;
    return {origin_W + Eigen::Vector3d(c * point.x() - s * point.y(), s * point.x() + c * point.y(),
                                       point.z()),
            {c * turn.c - s * turn.s, s * turn.c + c * turn.s}};
  }
};

/// Builds an object of shapes that are given in its frame B, whose pose in W is `place`. Lengths in
/// m.
class Builder {
 public:
  Builder(SceneObject object, const Place& place) : object_(std::move(object)) {
    const auto& [c, s] = place.heading;
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() << c, -s, s, c;
    T_W_B_.linear() = R;
    T_W_B_.translation() = place.origin_W;
  }

  Builder& Box(const Eigen::Vector3d& center_B, const Eigen::Vector3d& half_size) {
    return Add(Shape::Kind::kBox, center_B, half_size);
  }
  Builder& Ellipsoid(const Eigen::Vector3d& center_B, const Eigen::Vector3d& radii) {
    return Add(Shape::Kind::kEllipsoid, center_B, radii);
  }
  Builder& Cylinder(const Eigen::Vector3d& center_B, double radius, double half_height) {
    return Add(Shape::Kind::kCylinder, center_B, {radius, radius, half_height});
  }
  operator SceneObject() const { return object_; }  // NOLINT: a builder converts to its object

 private:
  Builder& Add(Shape::Kind kind, const Eigen::Vector3d& center_B, const Eigen::Vector3d& half) {
    Shape shape{kind, T_W_B_, half};
    shape.T_W_O.translation() = T_W_B_ * center_B;
    object_.shapes.push_back(shape);
    return *this;
  }

  SceneObject object_;
  Pose T_W_B_ = Pose::Identity();
};

/// Numbers the objects of a scene from 1 and collects them.
class Furniture {
 public:
  explicit Furniture(std::vector<SceneObject>* objects) : objects_(objects) {}

  SceneObject Structure(const char* name, Rgb8 color) const {
    return {NextId(), name, ClassId::kUnknown, ObjectKind::kStructure, color, {}};
  }
  /// An object of a COCO class; `name` is the COCO name of `coco_id`.
  SceneObject Known(const char* name, int coco_id, Rgb8 color) const {
    return {NextId(), name, static_cast<ClassId>(coco_id), ObjectKind::kKnown, color, {}};
  }
  SceneObject Unknown(const char* name, Rgb8 color) const {
    return {NextId(), name, ClassId::kUnknown, ObjectKind::kUnknown, color, {}};
  }
  void Put(const SceneObject& object) { objects_->push_back(object); }

 private:
  uint16_t NextId() const { return static_cast<uint16_t>(objects_->size() + 1); }

  std::vector<SceneObject>* objects_;
};

}  // namespace vismap
