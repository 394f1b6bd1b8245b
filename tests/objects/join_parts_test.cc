#include "objects/join_parts.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace vismap {
namespace {

constexpr SegmentLabel kPartA{1}, kPartB{2}, kNearby{3};

/// Meshes of plates and boxes whose sides are whole centimetres. Vertices at the same place are
/// one vertex, which has the label of what was added first, so that plates that touch are
/// connected.
class Scene {
 public:
  /// A plate of nu x nv cm from `corner`, along the axes u and v (0 to 2), that faces `normal`.
  void AddPlate(const Eigen::Vector3i& corner, int u, int v, int nu, int nv,
                const Eigen::Vector3f& normal, SegmentLabel label) {
    const auto at = [&](int i, int j) {
      Eigen::Vector3i place = corner;
      place[u] += i;
      place[v] += j;
      return VertexAt(place, normal, label);
    };
    const bool flipped = Eigen::Vector3f::Unit(u).cross(Eigen::Vector3f::Unit(v)).dot(normal) < 0;
    for (int i = 0; i < nu; ++i) {
      for (int j = 0; j < nv; ++j) {
        const uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
        AddTriangle({a, b, c}, flipped);
        AddTriangle({a, c, d}, flipped);
      }
    }
  }

  /// The four sides and the top of a box of `size` cm.
  void AddBox(const Eigen::Vector3i& corner, const Eigen::Vector3i& size, SegmentLabel label) {
    using Eigen::Vector3f, Eigen::Vector3i;
    const int x = size.x(), y = size.y(), z = size.z();
    AddPlate(corner + Vector3i(0, 0, z), 0, 1, x, y, Vector3f::UnitZ(), label);
    AddPlate(corner, 0, 2, x, z, -Vector3f::UnitY(), label);
    AddPlate(corner + Vector3i(0, y, 0), 0, 2, x, z, Vector3f::UnitY(), label);
    AddPlate(corner, 1, 2, y, z, -Vector3f::UnitX(), label);
    AddPlate(corner + Vector3i(x, 0, 0), 1, 2, y, z, Vector3f::UnitX(), label);
  }

  bool Joins(const LabelTable& bonds = {}, const ObjectOptions& options = {}) const {
    LabelTable table = bonds;
    table.GrowLabels(SegmentLabel{4});
    const auto whole_of = JoinParts(table, mesh, CollectSurfaces(mesh, 4), options);
    EXPECT_EQ(whole_of[Raw(kPartA)], kPartA);
    EXPECT_EQ(whole_of[Raw(kNearby)], kNearby);
    return whole_of[Raw(kPartB)] == kPartA;
  }

  Mesh mesh;

 private:
  uint32_t VertexAt(const Eigen::Vector3i& place, const Eigen::Vector3f& normal,
                    SegmentLabel label) {
    const std::array<int, 3> key{place.x(), place.y(), place.z()};
    const auto [found, added] = at_.emplace(key, static_cast<uint32_t>(mesh.vertices.size()));
    if (added) {
      MeshVertex vertex;
      vertex.position_W = place.cast<float>() / 100;
      vertex.normal_W = normal;
      vertex.segment = label;
      mesh.vertices.push_back(vertex);
    }
    return found->second;
  }

  void AddTriangle(std::array<uint32_t, 3> corners, bool flipped) {
    if (flipped) std::swap(corners[1], corners[2]);
    mesh.triangles.push_back(corners);
  }

  std::map<std::array<int, 3>, uint32_t> at_;
};

/// An upright panel of 60 x `height` cm with a board of 60 x 10 cm that begins at 30 cm.
Scene PanelWithBoard(int width = 60, int height = 60) {
  Scene scene;
  scene.AddPlate({0, 0, 0}, 0, 2, width, height, Eigen::Vector3f::UnitY(), kPartA);
  scene.AddPlate({0, 0, 30}, 0, 1, 60, 10, Eigen::Vector3f::UnitZ(), kPartB);
  return scene;
}

/// A box of 20 cm on one of 40 x 40 x 20 cm.
Scene BoxOnBox() {
  Scene scene;
  scene.AddBox({0, 0, 0}, {40, 40, 20}, kPartA);
  scene.AddBox({10, 10, 20}, {20, 20, 20}, kPartB);
  return scene;
}

/// A pole of 1 m on a floor, and a box of 30 x 30 x 20 cm that begins `gap` cm above its top.
Scene PoleUnderShade(int beside, int gap) {
  Scene scene;
  scene.AddPlate({-80, -80, 0}, 0, 1, 160, 160, Eigen::Vector3f::UnitZ(), kNearby);
  scene.AddBox({-2, -2, 0}, {4, 4, 100}, kPartA);
  scene.AddBox({beside - 15, -15, 100 + gap}, {30, 30, 20}, kPartB);
  return scene;
}

/// Bonds of the two labels after one frame that has them under one mask, and `apart` frames that
/// have them under two.
LabelTable Masked(int apart) {
  LabelTable table;
  table.GrowLabels(SegmentLabel{4});
  const auto see = [&](uint16_t second) {
    const std::array<MaskedLabel, 2> seen{MaskedLabel{kPartA, DetectionIndex{0}, 0.9F},
                                          MaskedLabel{kPartB, DetectionIndex{second}, 0.9F}};
    table.MutableBonds().AddFrame(seen);
  };
  see(0);
  for (int i = 0; i < apart; ++i) see(1);
  return table;
}

TEST(JoinParts, PanelAndBoardAreOneThing) { EXPECT_TRUE(PanelWithBoard().Joins()); }

TEST(JoinParts, WhatRestsOnSomethingIsAnotherThing) { EXPECT_FALSE(BoxOnBox().Joins()); }

TEST(JoinParts, MasksDecideForAndAgainst) {
  EXPECT_TRUE(BoxOnBox().Joins(Masked(0)));
  EXPECT_FALSE(BoxOnBox().Joins(Masked(1))) << "evidence for and against is equal";
  EXPECT_FALSE(PanelWithBoard().Joins(Masked(2)));
}

TEST(JoinParts, StructureIsKeptOut) {
  EXPECT_TRUE(PanelWithBoard(90, 90).Joins());
  EXPECT_FALSE(PanelWithBoard(120, 120).Joins()) << "the panel is a wall";
}

TEST(JoinParts, NothingTooLargeIsMade) {
  EXPECT_FALSE(PanelWithBoard().Joins({}, {.max_whole_size_m = 0.84}));
  EXPECT_TRUE(PanelWithBoard().Joins({}, {.max_whole_size_m = 0.86}));
}

TEST(JoinParts, AThingThatGoesOnIntoLargeSurfaceStaysInParts) {
  Scene scene = PanelWithBoard();
  // A bent surface of 3 m, which is neither a plane nor small enough for a part.
  for (int step = 0; step < 10; ++step) {
    scene.AddPlate({0, 10 + 30 * step, 30 + 20 * step}, 0, 1, 60, 30, Eigen::Vector3f::UnitZ(),
                   kNearby);
    scene.AddPlate({0, 40 + 30 * step, 30 + 20 * step}, 0, 2, 60, 20, -Eigen::Vector3f::UnitY(),
                   kNearby);
  }
  EXPECT_FALSE(scene.Joins());
  EXPECT_TRUE(scene.Joins({}, {.max_whole_leak = 1}));
}

TEST(JoinParts, WhatFloatsIsHeldByThePoleBelowIt) {
  EXPECT_TRUE(PoleUnderShade(0, 10).Joins());
  EXPECT_FALSE(PoleUnderShade(0, 30).Joins()) << "too far above";
  EXPECT_FALSE(PoleUnderShade(40, 10).Joins()) << "beside it";
}

TEST(JoinParts, WhatStandsOnSomethingWiderIsAnotherThing) {
  Scene scene;
  scene.AddPlate({-80, -80, 0}, 0, 1, 160, 160, Eigen::Vector3f::UnitZ(), kNearby);
  scene.AddBox({-20, -20, 0}, {40, 40, 60}, kPartA);
  scene.AddBox({-10, -10, 63}, {20, 20, 20}, kPartB);
  EXPECT_FALSE(scene.Joins()) << "only their contact was not seen";
}

TEST(JoinParts, PartsShowTheFirstSegmentOfTheirObject) {
  Scene scene = BoxOnBox();
  ObjectSummary whole, named;
  whole.segments = {kPartA, kPartB};
  named.instance = InstanceId{5};
  named.segments = {kPartB, kNearby};
  Mesh mesh = scene.mesh;
  ShowWholeObjects({named}, &mesh);
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    ASSERT_EQ(mesh.vertices[i].segment, scene.mesh.vertices[i].segment);
  ShowWholeObjects({named, whole}, &mesh);
  for (const MeshVertex& vertex : mesh.vertices) ASSERT_EQ(vertex.segment, kPartA);
}

}  // namespace
}  // namespace vismap
