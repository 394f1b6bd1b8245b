#include "objects/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

namespace vismap {
namespace {

constexpr SegmentLabel kFloorBelow{1}, kLeg{2}, kRug{3};
constexpr InstanceId kTable{7};
constexpr int kSide = 130;  // vertices, 1 cm apart: 1.7 m^2
constexpr double kDistance = 0.0075;

struct Point {
  float height = 0;
  SegmentLabel segment = kFloorBelow;
};

/// A sheet of floor. All segments except the floor and the rug belong to the table.
Mesh Sheet(const std::function<Point(int, int)>& point, int side = kSide) {
  Mesh mesh;
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      const Point at = point(u, v);
      MeshVertex vertex;
      vertex.position_W = {static_cast<float>(0.01 * u), static_cast<float>(0.01 * v), at.height};
      vertex.normal_W = Eigen::Vector3f::UnitZ();
      vertex.segment = at.segment;
      if (at.segment == kLeg) vertex.instance = kTable;
      mesh.vertices.push_back(vertex);
    }
  }
  const auto at = [&](int u, int v) { return static_cast<uint32_t>(v * side + u); };
  for (int v = 0; v + 1 < side; ++v) {
    for (int u = 0; u + 1 < side; ++u) {
      mesh.triangles.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1)});
      mesh.triangles.push_back({at(u, v), at(u + 1, v + 1), at(u, v + 1)});
    }
  }
  return mesh;
}

/// The distance of a vertex from the middle in the maximum norm [vertices].
int Ring(int u, int v) { return std::max(std::abs(u - kSide / 2), std::abs(v - kSide / 2)); }

/// A leg of 9 x 9 vertices: its outermost ring is at the given height, the rest above.
Point WithLeg(int u, int v, float rim) {
  if (Ring(u, v) > 4) return {};
  return {Ring(u, v) == 4 ? rim : 0.3F, kLeg};
}

int Count(const Mesh& mesh, SegmentLabel segment) {
  int count = 0;
  for (const MeshVertex& vertex : mesh.vertices) count += vertex.segment == segment;
  return count;
}

TEST(AbsorbContacts, GivesTheRimOfALegToTheFloor) {
  Mesh mesh = Sheet([](int u, int v) { return WithLeg(u, v, 0.005F); });
  ASSERT_EQ(Count(mesh, kLeg), 81);
  AbsorbContacts(kDistance, &mesh);
  EXPECT_EQ(Count(mesh, kLeg), 49) << "the outermost ring of 32 is floor, and nothing else";
  EXPECT_EQ(Count(mesh, kFloorBelow), kSide * kSide - 49);
}

TEST(AbsorbContacts, LeavesWhatIsHigher) {
  Mesh mesh = Sheet([](int u, int v) { return WithLeg(u, v, 0.015F); });
  AbsorbContacts(kDistance, &mesh);
  EXPECT_EQ(Count(mesh, kLeg), 81);
}

TEST(AbsorbContacts, LeavesTheRimOfWhatIsFlat) {
  for (const float height : {0.002F, 0.09F, 0.11F}) {
    Mesh mesh = Sheet([&](int u, int v) {
      if (Ring(u, v) > 20) return Point{};
      return Point{Ring(u, v) == 20 ? 0.002F : height, kRug};
    });
    AbsorbContacts(kDistance, &mesh);
    EXPECT_EQ(Count(mesh, kRug), height < 0.1F ? 41 * 41 : 39 * 39) << height;
  }
}

TEST(AbsorbContacts, AnInstanceStandsAsAWhole) {
  constexpr SegmentLabel kCastor{4};  // less than 10 cm high, but part of the table
  Mesh mesh = Sheet([](int u, int v) {
    if (Ring(u, v) > 4) return Point{};
    return Point{Ring(u, v) == 4 ? 0.005F : 0.3F, Ring(u, v) < 3 ? kLeg : kCastor};
  });
  for (MeshVertex& vertex : mesh.vertices) {
    if (vertex.segment == kCastor) vertex.instance = kTable;
    if (vertex.segment == kCastor) vertex.position_W.z() = std::min(vertex.position_W.z(), 0.05F);
  }
  AbsorbContacts(kDistance, &mesh);
  EXPECT_EQ(Count(mesh, kCastor), 7 * 7 - 5 * 5);
  EXPECT_EQ(Count(mesh, kLeg), 5 * 5);
}

TEST(AbsorbContacts, SmallOrRoughSurfacesAreNoStructure) {
  constexpr int kSmall = 80;  // 0.64 m^2
  const auto leg = [](int u, int v) { return WithLeg(u, v, 0.005F); };
  Mesh small = Sheet(leg, kSmall);
  const int before = Count(small, kLeg);
  AbsorbContacts(kDistance, &small);
  EXPECT_EQ(Count(small, kLeg), before);

  Mesh rough = Sheet([&](int u, int v) {
    Point point = leg(u, v);
    if (point.segment == kFloorBelow)
      point.height = 0.1F * static_cast<float>((u / 10 + v / 10) % 3);
    return point;
  });
  AbsorbContacts(kDistance, &rough);
  EXPECT_EQ(Count(rough, kLeg), 81);
}

TEST(AbsorbContacts, InstancesAreNoStructure) {
  Mesh mesh = Sheet([](int u, int v) { return WithLeg(u, v, 0.005F); });
  for (MeshVertex& vertex : mesh.vertices) {
    if (vertex.segment == kFloorBelow) vertex.instance = InstanceId{8};  // such as a bed
  }
  AbsorbContacts(kDistance, &mesh);
  EXPECT_EQ(Count(mesh, kLeg), 81);
}

TEST(AbsorbContacts, DoesNothingWithNothing) {
  Mesh mesh;
  AbsorbContacts(kDistance, &mesh);
  EXPECT_TRUE(mesh.vertices.empty());
}

}  // namespace
}  // namespace vismap
