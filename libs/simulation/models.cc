#include "simulation/models.h"

namespace vismap {

SceneObject Chair(const SceneObject& object, const Place& place) {
  Builder chair(object, place);
  chair.Box({0, 0, 0.455}, {0.21, 0.21, 0.025}).Box({-0.19, 0, 0.7}, {0.02, 0.21, 0.22});
  for (const double x : {-0.18, 0.18}) {
    for (const double y : {-0.18, 0.18}) chair.Box({x, y, 0.215}, {0.02, 0.02, 0.215});
  }
  return chair;
}

SceneObject Table(const SceneObject& object, const Place& place) {
  Builder table(object, place);
  table.Box({0, 0, 0.74}, {0.6, 0.4, 0.02});
  for (const double x : {-0.54, 0.54}) {
    for (const double y : {-0.34, 0.34}) table.Cylinder({x, y, 0.36}, 0.03, 0.36);
  }
  return table;
}

SceneObject Couch(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.21}, {0.9, 0.4, 0.21})
      .Box({0, -0.31, 0.63}, {0.9, 0.09, 0.21})
      .Box({-0.82, 0.09, 0.51}, {0.08, 0.31, 0.09})
      .Box({0.82, 0.09, 0.51}, {0.08, 0.31, 0.09});
}

SceneObject Television(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.02}, {0.15, 0.09, 0.02})
      .Box({0, 0, 0.06}, {0.03, 0.02, 0.03})
      .Box({0, 0, 0.37}, {0.45, 0.025, 0.28});
}

SceneObject PottedPlant(const SceneObject& object, const Place& place, double size) {
  return Builder(object, place)
      .Cylinder({0, 0, 0.15 * size}, 0.16 * size, 0.15 * size)
      .Cylinder({0, 0, 0.4 * size}, 0.03 * size, 0.12 * size)
      .Ellipsoid({0, 0, 0.75 * size}, {0.28 * size, 0.28 * size, 0.33 * size});
}

SceneObject Lamp(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Cylinder({0, 0, 0.015}, 0.16, 0.015)
      .Cylinder({0, 0, 0.72}, 0.02, 0.7)
      .Cylinder({0, 0, 1.55}, 0.2, 0.15);
}

SceneObject Backpack(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.23}, {0.16, 0.1, 0.23})
      .Box({0, 0.13, 0.17}, {0.12, 0.05, 0.12});
}

SceneObject Cup(const SceneObject& object, const Place& place) {
  return Builder(object, place).Cylinder({0, 0, 0.05}, 0.045, 0.05);
}

SceneObject Book(const SceneObject& object, const Place& place) {
  return Builder(object, place).Box({0, 0, 0.025}, {0.14, 0.1, 0.025});
}

SceneObject Bottle(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Cylinder({0, 0, 0.1}, 0.045, 0.1)
      .Cylinder({0, 0, 0.24}, 0.018, 0.04);
}

SceneObject Bowl(const SceneObject& object, const Place& place) {
  return Builder(object, place).Cylinder({0, 0, 0.035}, 0.11, 0.035);
}

SceneObject Vase(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Ellipsoid({0, 0, 0.13}, {0.1, 0.1, 0.135})
      .Cylinder({0, 0, 0.27}, 0.04, 0.05);
}

SceneObject Block(const SceneObject& object, const Place& place, const Eigen::Vector3d& size) {
  return Builder(object, place).Box({0, 0, 0.5 * size.z()}, 0.5 * size);
}

SceneObject Drum(const SceneObject& object, const Place& place, double radius, double height) {
  return Builder(object, place).Cylinder({0, 0, 0.5 * height}, radius, 0.5 * height);
}

SceneObject Desk(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.72}, {0.8, 0.4, 0.02})
      .Box({-0.76, 0, 0.35}, {0.02, 0.36, 0.35})
      .Box({0.76, 0, 0.35}, {0.02, 0.36, 0.35});
}

SceneObject OfficeChair(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Cylinder({0, 0, 0.04}, 0.26, 0.04)
      .Cylinder({0, 0, 0.255}, 0.035, 0.175)
      .Box({0, 0, 0.46}, {0.23, 0.23, 0.03})
      .Box({-0.21, 0, 0.75}, {0.03, 0.2, 0.26});
}

SceneObject Monitor(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.01}, {0.12, 0.09, 0.01})
      .Box({0, 0.03, 0.14}, {0.03, 0.02, 0.12})
      .Box({0, -0.01, 0.3}, {0.28, 0.02, 0.17});
}

SceneObject Laptop(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Box({0, 0, 0.012}, {0.17, 0.12, 0.012})
      .Box({0, 0.135, 0.12}, {0.17, 0.015, 0.12});
}

SceneObject DeskLamp(const SceneObject& object, const Place& place) {
  return Builder(object, place)
      .Cylinder({0, 0, 0.01}, 0.08, 0.01)
      .Cylinder({0, 0, 0.19}, 0.015, 0.17)
      .Cylinder({0, 0, 0.42}, 0.09, 0.06);
}

}  // namespace vismap
