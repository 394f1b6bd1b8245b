#include "simulation/room.h"

#include <array>

#include "base/require.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

/// Heading of an object around z as (cosine, sine): exact numbers where a libm's would vary.
struct Heading {
  double c = 1;
  double s = 0;
};
constexpr Heading kAhead{1, 0}, kLittle{0.96, 0.28}, kMuch{0.8, 0.6}, kLeft{0, 1}, kBack{-1, 0};

/// Puts shapes together in the frame of an object that stands at `place` with `heading`.
class Builder {
 public:
  Builder(SceneObject object, const Vector3d& place, Heading heading) : object_(std::move(object)) {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() << heading.c, -heading.s, heading.s, heading.c;
    T_W_B_.linear() = R;
    T_W_B_.translation() = place;
  }

  Builder& Add(Shape::Kind kind, const Vector3d& center_B, const Vector3d& half_size) {
    Shape shape{kind, T_W_B_, half_size};
    shape.T_W_O.translation() = T_W_B_ * center_B;
    object_.shapes.push_back(shape);
    return *this;
  }
  Builder& Box(const Vector3d& center_B, const Vector3d& half_size) {
    return Add(Shape::Kind::kBox, center_B, half_size);
  }
  Builder& Ellipsoid(const Vector3d& center_B, const Vector3d& radii) {
    return Add(Shape::Kind::kEllipsoid, center_B, radii);
  }
  Builder& Cylinder(const Vector3d& center_B, double radius, double half_height) {
    return Add(Shape::Kind::kCylinder, center_B, {radius, radius, half_height});
  }
  operator SceneObject() const { return object_; }  // NOLINT: a builder stands for what it built

 private:
  SceneObject object_;
  Pose T_W_B_ = Pose::Identity();
};

/// Floor, ceiling, walls: slabs outside of the free space.
void AddStructure(std::vector<SceneObject>* objects) {
  constexpr double kX = 2.5, kY = 2.0, kHeight = 2.6, kThick = 0.1;
  const auto add = [&](const char* name, Rgb8 color, const Vector3d& center, const Vector3d& half) {
    const auto id = static_cast<uint16_t>(objects->size() + 1);
    objects->push_back(Builder({id, name, ClassId::kUnknown, ObjectKind::kStructure, color, {}},
                               Vector3d::Zero(), kAhead)
                           .Box(center, half));
  };
  const double middle = kHeight / 2, t = kThick;
  add("floor", {150, 120, 90}, {0, 0, -t}, {kX + 2 * t, kY + 2 * t, t});
  add("ceiling", {230, 230, 225}, {0, 0, kHeight + t}, {kX + 2 * t, kY + 2 * t, t});
  add("wall", {200, 205, 190}, {-kX - t, 0, middle}, {t, kY + 2 * t, middle});
  add("wall", {190, 205, 205}, {kX + t, 0, middle}, {t, kY + 2 * t, middle});
  add("wall", {210, 200, 185}, {0, -kY - t, middle}, {kX, t, middle});
  add("wall", {205, 195, 205}, {0, kY + t, middle}, {kX, t, middle});
}

/// Gives objects their running ids.
class Furniture {
 public:
  explicit Furniture(std::vector<SceneObject>* objects) : objects_(objects) {}

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

Builder Chair(const SceneObject& object, const Vector3d& place, Heading heading) {
  Builder chair(object, place, heading);
  chair.Box({0, 0, 0.455}, {0.21, 0.21, 0.025}).Box({-0.19, 0, 0.7}, {0.02, 0.21, 0.22});
  for (const double x : {-0.18, 0.18}) {
    for (const double y : {-0.18, 0.18}) chair.Box({x, y, 0.215}, {0.02, 0.02, 0.215});
  }
  return chair;
}

Builder Table(const SceneObject& object, const Vector3d& place, Heading heading) {
  Builder table(object, place, heading);
  table.Box({0, 0, 0.74}, {0.6, 0.4, 0.02});
  for (const double x : {-0.54, 0.54}) {
    for (const double y : {-0.34, 0.34}) table.Cylinder({x, y, 0.36}, 0.03, 0.36);
  }
  return table;
}

Builder Couch(const SceneObject& object, const Vector3d& place, Heading heading) {
  return Builder(object, place, heading)
      .Box({0, 0, 0.21}, {0.9, 0.4, 0.21})
      .Box({0, -0.31, 0.63}, {0.9, 0.09, 0.21})
      .Box({-0.82, 0.09, 0.51}, {0.08, 0.31, 0.09})
      .Box({0.82, 0.09, 0.51}, {0.08, 0.31, 0.09});
}

void AddLargeThings(Furniture* room) {
  room->Put(Table(room->Known("dining table", 67, {150, 95, 50}), {0, 0, 0}, kAhead));
  room->Put(Chair(room->Known("chair", 62, {60, 90, 160}), {-0.85, 0.05, 0}, kLittle));
  room->Put(Chair(room->Known("chair", 62, {60, 140, 90}), {0.85, -0.1, 0}, kBack));
  room->Put(Couch(room->Known("couch", 63, {150, 60, 60}), {-0.9, -1.58, 0}, kAhead));
  room->Put(Builder(room->Unknown("cabinet", {220, 215, 200}), {0.2, 1.78, 0}, kAhead)
                .Box({0, 0, 0.25}, {0.75, 0.2, 0.25}));
  room->Put(Builder(room->Known("tv", 72, {25, 25, 30}), {0, 1.85, 0.5}, kAhead)
                .Box({0, 0, 0.02}, {0.15, 0.09, 0.02})
                .Box({0, 0, 0.06}, {0.03, 0.02, 0.03})
                .Box({0, 0, 0.37}, {0.45, 0.025, 0.28}));
  room->Put(Builder(room->Known("potted plant", 64, {50, 120, 50}), {2.05, 1.55, 0}, kAhead)
                .Cylinder({0, 0, 0.15}, 0.16, 0.15)
                .Cylinder({0, 0, 0.4}, 0.03, 0.12)
                .Ellipsoid({0, 0, 0.75}, {0.28, 0.28, 0.33}));
  room->Put(Builder(room->Unknown("lamp", {235, 200, 120}), {2.1, -1.6, 0}, kAhead)
                .Cylinder({0, 0, 0.015}, 0.16, 0.015)
                .Cylinder({0, 0, 0.72}, 0.02, 0.7)
                .Cylinder({0, 0, 1.55}, 0.2, 0.15));
  room->Put(Builder(room->Unknown("box", {180, 140, 95}), {-2.0, 1.45, 0}, kLittle)
                .Box({0, 0, 0.22}, {0.3, 0.25, 0.22}));
  room->Put(Builder(room->Unknown("small box", {200, 165, 120}), {-2.0, 1.45, 0.44}, kMuch)
                .Box({0, 0, 0.12}, {0.16, 0.14, 0.12}));
  room->Put(Builder(room->Unknown("speaker", {90, 90, 95}), {1.3, -1.75, 0}, kAhead)
                .Box({0, 0, 0.45}, {0.13, 0.15, 0.45}));
  room->Put(Builder(room->Unknown("pillow", {230, 190, 60}), {-1.3, -1.68, 0.42}, kAhead)
                .Ellipsoid({0, 0, 0.17}, {0.22, 0.11, 0.18}));
}

void AddSmallThings(Furniture* room) {
  const double table = 0.76, cabinet = 0.5;
  room->Put(Builder(room->Known("backpack", 27, {40, 60, 120}), {2.25, 0.55, 0}, kLeft)
                .Box({0, 0, 0.23}, {0.16, 0.1, 0.23})
                .Box({0, 0.13, 0.17}, {0.12, 0.05, 0.12}));
  room->Put(Builder(room->Known("cup", 47, {235, 235, 240}), {0.3, 0.12, table}, kAhead)
                .Cylinder({0, 0, 0.05}, 0.045, 0.05));
  room->Put(Builder(room->Known("book", 84, {170, 40, 50}), {-0.25, -0.12, table}, kMuch)
                .Box({0, 0, 0.025}, {0.14, 0.1, 0.025}));
  room->Put(Builder(room->Known("bottle", 44, {30, 110, 70}), {-0.2, 0.2, table}, kAhead)
                .Cylinder({0, 0, 0.1}, 0.045, 0.1)
                .Cylinder({0, 0, 0.24}, 0.018, 0.04));
  room->Put(Builder(room->Known("bowl", 51, {90, 160, 200}), {0.15, -0.2, table}, kAhead)
                .Cylinder({0, 0, 0.035}, 0.11, 0.035));
  room->Put(Builder(room->Known("vase", 86, {120, 70, 150}), {0.75, 1.75, cabinet}, kAhead)
                .Ellipsoid({0, 0, 0.13}, {0.1, 0.1, 0.135})
                .Cylinder({0, 0, 0.27}, 0.04, 0.05));
}

/// Closed Catmull-Rom curve through the points; `s` in [0, points.size()).
Vector3d CurveAt(const std::vector<Vector3d>& points, double s) {
  const size_t n = points.size();
  const auto k = static_cast<size_t>(s);
  const double x = s - static_cast<double>(k);
  const Vector3d& a = points[(k + n - 1) % n];
  const Vector3d& b = points[k % n];
  const Vector3d& c = points[(k + 1) % n];
  const Vector3d& d = points[(k + 2) % n];
  return b + 0.5 * x * ((c - a) + x * ((2 * a - 5 * b + 4 * c - d) + x * (3 * (b - c) + d - a)));
}

}  // namespace

Scene MakeRoom() {
  Scene scene{"room", {}};
  AddStructure(&scene.objects);
  Furniture room(&scene.objects);
  AddLargeThings(&room);
  AddSmallThings(&room);
  return scene;
}

Pose LookAt(const Vector3d& eye_W, const Vector3d& target_W) {
  const Vector3d forward = (target_W - eye_W).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ());
  Require(right.norm() > 1e-6, "a camera with a level horizon does not look straight up or down");
  Pose T_W_C = Pose::Identity();
  T_W_C.linear().col(0) = right.normalized();
  T_W_C.linear().col(1) = forward.cross(T_W_C.linear().col(0));
  T_W_C.linear().col(2) = forward;
  T_W_C.translation() = eye_W;
  return T_W_C;
}

std::vector<Pose> MakeRoomTour(int count) {
  Require(count >= 1, "a tour has at least one pose");
  constexpr double kHalf = 0.70710678118654752;
  constexpr std::array<Heading, 8> kRound{{{1, 0},
                                           {kHalf, kHalf},
                                           {0, 1},
                                           {-kHalf, kHalf},
                                           {-1, 0},
                                           {-kHalf, -kHalf},
                                           {0, -1},
                                           {kHalf, -kHalf}}};
  std::vector<Vector3d> eyes, targets;
  for (const Heading at : kRound) {  // from the edge of the room across the table
    eyes.emplace_back(1.7 * at.c, 1.25 * at.s, 1.55);
    targets.emplace_back(-0.5 * at.c, -0.4 * at.s, 0.75);
  }
  for (const Heading at : kRound) {  // from the middle to the walls, turning on as before
    eyes.emplace_back(0.6 * at.c, 0.5 * at.s, 1.5);
    targets.emplace_back(-2.4 * at.c, -1.9 * at.s, 0.6);
  }
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double s = static_cast<double>(eyes.size()) * i / count;
    poses.push_back(LookAt(CurveAt(eyes, s), CurveAt(targets, s)));
  }
  return poses;
}

}  // namespace vismap
