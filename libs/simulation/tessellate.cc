#include "simulation/tessellate.h"

#include <algorithm>
#include <cmath>

namespace vismap {
namespace {

using Eigen::Vector3d;

/// A part of a shape's surface: a function from (a, b) in [0, 1]^2 to a point in the shape's frame.
struct Patch {
  std::function<Vector3d(double a, double b)> point_O;
  int a_steps = 1;
  int b_steps = 1;
};

int StepsFor(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / spacing)));
}

std::vector<Patch> BoxPatches(const Vector3d& half, double spacing) {
  std::vector<Patch> patches;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int i = (axis + 1) % 3, k = (axis + 2) % 3;
      const auto point = [=](double a, double b) {
        Vector3d p = Vector3d::Unit(axis) * (side * half[axis]);
        p[i] = (2 * a - 1) * half[i];
        p[k] = (2 * b - 1) * half[k];
        return p;
      };
      patches.push_back({point, StepsFor(2 * half[i], spacing), StepsFor(2 * half[k], spacing)});
    }
  }
  return patches;
}

std::vector<Patch> EllipsoidPatches(const Vector3d& radii, double spacing) {
  const auto point = [=](double a, double b) {
    const double polar = M_PI * a, turn = 2 * M_PI * b;
    return Vector3d(radii.x() * std::sin(polar) * std::cos(turn),
                    radii.y() * std::sin(polar) * std::sin(turn), radii.z() * std::cos(polar));
  };
  const double largest = radii.maxCoeff();
  return {{point, StepsFor(M_PI * largest, spacing), StepsFor(2 * M_PI * largest, spacing)}};
}

std::vector<Patch> CylinderPatches(const Vector3d& half, double spacing) {
  const double radius = half.x();
  const int around = std::max(8, StepsFor(2 * M_PI * radius, spacing));
  const auto ring = [=](double r, double b, double z) {
    return Vector3d(r * std::cos(2 * M_PI * b), r * std::sin(2 * M_PI * b), z);
  };
  std::vector<Patch> patches;
  patches.push_back({[=](double a, double b) { return ring(radius, b, (2 * a - 1) * half.z()); },
                     StepsFor(2 * half.z(), spacing), around});
  for (const double side : {-1.0, 1.0}) {
    patches.push_back({[=](double a, double b) { return ring(a * radius, b, side * half.z()); },
                       StepsFor(radius, spacing), around});
  }
  return patches;
}

std::vector<Patch> PatchesOf(const Shape& shape, double spacing) {
  switch (shape.kind) {
    case Shape::Kind::kBox:
      return BoxPatches(shape.half_size, spacing);
    case Shape::Kind::kEllipsoid:
      return EllipsoidPatches(shape.half_size, spacing);
    case Shape::Kind::kCylinder:
      return CylinderPatches(shape.half_size, spacing);
  }
  return {};
}

/// Adds the grid of a patch. Points for which `wanted` is false, and their triangles, are left out.
void AddPatch(const Patch& patch, const Shape& shape, uint16_t id,
              const std::function<bool(const Vector3d&, const Vector3d&)>& wanted,
              LabelledMesh* mesh) {
  const int row = patch.b_steps + 1;
  std::vector<int> index;  // index of each grid point in the mesh; -1 = left out
  for (int i = 0; i <= patch.a_steps; ++i) {
    for (int k = 0; k <= patch.b_steps; ++k) {
      const Vector3d p_O = patch.point_O(static_cast<double>(i) / patch.a_steps,
                                         static_cast<double>(k) / patch.b_steps);
      const Vector3d p_W = shape.T_W_O * p_O;
      const Vector3d normal_W = shape.T_W_O.linear() * OutwardNormal(shape, p_O);
      index.push_back(-1);
      if (!wanted(p_W, normal_W)) continue;
      index.back() = static_cast<int>(mesh->points_W.size());
      mesh->points_W.push_back(p_W);
      mesh->object_ids.push_back(id);
    }
  }
  const auto add = [&](int a, int b, int c) {
    const std::array<int, 3> corners{index[static_cast<size_t>(a)], index[static_cast<size_t>(b)],
                                     index[static_cast<size_t>(c)]};
    if (*std::min_element(corners.begin(), corners.end()) >= 0) mesh->triangles.push_back(corners);
  };
  for (int i = 0; i < patch.a_steps; ++i) {
    for (int k = 0; k < patch.b_steps; ++k) {
      const int at = i * row + k;
      add(at, at + 1, at + row);
      add(at + 1, at + row + 1, at + row);
    }
  }
}

}  // namespace

LabelledMesh Tessellate(const Scene& scene, double spacing,
                        const std::function<bool(const Vector3d&, const Vector3d&)>& keep) {
  constexpr double kInFront = 1e-4;
  // The tolerance prevents that rounding decides about points where shapes touch.
  const auto wanted = [&](const Vector3d& p_W, const Vector3d& normal_W) {
    return keep(p_W, normal_W) && SignedDistance(scene, p_W + kInFront * normal_W) > 0.1 * kInFront;
  };
  LabelledMesh mesh;
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) {
      for (const Patch& patch : PatchesOf(shape, spacing)) {
        AddPatch(patch, shape, object.id, wanted, &mesh);
      }
    }
  }
  return mesh;
}

}  // namespace vismap
