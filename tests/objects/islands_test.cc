#include "objects/islands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>

namespace vismap {
namespace {

constexpr SegmentLabel kWall{1};
constexpr SegmentLabel kGround{2};
constexpr SegmentLabel kSeatLabel{3};
constexpr InstanceId kChairInstance{7};

struct Label {
  SegmentLabel segment = SegmentLabel::kNone;
  InstanceId instance = InstanceId::kNone;
};
constexpr Label kOnWall{kWall, InstanceId::kNone};
constexpr Label kOnGround{kGround, InstanceId::kNone};
constexpr Label kOnChair{kSeatLabel, kChairInstance};

/// A flat square of side x side vertices, 1 cm apart, that faces +z.
void AddSquare(int side, double x, const std::function<Label(int, int)>& label, Mesh* mesh) {
  const auto first = static_cast<uint32_t>(mesh->vertices.size());
  for (int v = 0; v < side; ++v) {
    for (int u = 0; u < side; ++u) {
      MeshVertex vertex;
      vertex.position_W = {static_cast<float>(x + 0.01 * u), static_cast<float>(0.01 * v), 0};
      vertex.normal_W = Eigen::Vector3f::UnitZ();
      vertex.segment = label(u, v).segment;
      vertex.instance = label(u, v).instance;
      mesh->vertices.push_back(vertex);
    }
  }
  const auto at = [&](int u, int v) { return first + static_cast<uint32_t>(v * side + u); };
  for (int v = 0; v + 1 < side; ++v) {
    for (int u = 0; u + 1 < side; ++u) {
      mesh->triangles.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1)});
      mesh->triangles.push_back({at(u, v), at(u + 1, v + 1), at(u, v + 1)});
    }
  }
}

/// A wall of 60 x 60 cm with something on it, and, if asked for, a chair of 40 x 40 cm far from it.
Mesh WallWith(const std::function<Label(int, int)>& label, bool chair = true) {
  Mesh mesh;
  AddSquare(60, 0, label, &mesh);
  if (chair)
    AddSquare(
        40, 5, [](int, int) { return kOnChair; }, &mesh);
  return mesh;
}

int64_t CountOf(const Mesh& mesh, SegmentLabel segment) {
  return std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                       [&](const MeshVertex& vertex) { return vertex.segment == segment; });
}

bool InDisc(int u, int v, int radius) {
  return (u - 30) * (u - 30) + (v - 30) * (v - 30) <= radius * radius;
}

/// Vertices of the chair that became wall.
int64_t Absorbed(Mesh mesh, const MeshingOptions& options = {}) {
  const int64_t before = CountOf(mesh, kSeatLabel);
  AbsorbIslands(options, &mesh);
  return before - CountOf(mesh, kSeatLabel);
}

TEST(AbsorbIslands, GivesShredsOfAMaskToTheWallTheyLieOn) {
  Mesh mesh = WallWith([](int u, int v) { return InDisc(u, v, 4) ? kOnChair : kOnWall; });
  const int64_t shred = CountOf(mesh, kSeatLabel) - 40 * 40;
  ASSERT_GT(shred, 40);
  EXPECT_EQ(Absorbed(mesh), shred);
  MeshingOptions off;
  off.island_max_share = 0;
  EXPECT_EQ(Absorbed(mesh, off), 0);
}

TEST(AbsorbIslands, LeavesWhatIsLargeForItsObjectOrLargeAtAll) {
  const auto cup_on_table = [](int u, int v) { return InDisc(u, v, 4) ? kOnChair : kOnWall; };
  EXPECT_EQ(Absorbed(WallWith(cup_on_table, false)), 0) << "all that there is of it";
  const auto cushion = [](int u, int v) { return InDisc(u, v, 6) ? kOnChair : kOnWall; };
  EXPECT_EQ(Absorbed(WallWith(cushion)), 0) << "more than 100 square centimetres";
  MeshingOptions larger;
  larger.island_max_area_m2 = 0.02;
  EXPECT_GT(Absorbed(WallWith(cushion), larger), 100);
}

TEST(AbsorbIslands, LeavesWhatStandsOnASurface) {
  // The end of a leg is as wide as the island, but its surface faces sideways.
  Mesh mesh = WallWith([](int u, int v) { return InDisc(u, v, 4) ? kOnChair : kOnWall; });
  for (size_t i = 0; i < 60 * 60; ++i) {
    if (mesh.vertices[i].segment != kSeatLabel) continue;
    const Eigen::Vector3f out = mesh.vertices[i].position_W - Eigen::Vector3f(0.3F, 0.3F, 0);
    mesh.vertices[i].normal_W = (out + Eigen::Vector3f(1e-4F, 0, 0)).normalized();
  }
  EXPECT_EQ(Absorbed(mesh), 0);
}

TEST(AbsorbIslands, LeavesWhatEndsWhereNothingWasSeen) {
  Mesh mesh;
  AddSquare(
      9, 0, [](int u, int) { return u < 6 ? kOnChair : kOnWall; }, &mesh);  // three open sides
  AddSquare(
      40, 5, [](int, int) { return kOnChair; }, &mesh);
  EXPECT_EQ(Absorbed(mesh), 0);
  const auto corner = [](int u, int v) { return u < 9 && v < 9 ? kOnChair : kOnWall; };
  EXPECT_EQ(Absorbed(WallWith(corner)), 81) << "two of four are open";
}

TEST(AbsorbIslands, LeavesWhatLiesBetweenOthers) {
  const auto between = [](int u, int v) {
    if (u >= 28 && u < 32 && v > 10 && v < 30) return kOnChair;
    return u < 30 ? kOnWall : kOnGround;
  };
  EXPECT_EQ(Absorbed(WallWith(between)), 0);
}

TEST(AbsorbIslands, LeavesNothingOfWhatIsAllShreds) {
  // The normals vary as with noise. An island must be flush only if its owner has a larger piece.
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 1);
  const auto shreds = [](int u, int v) { return u % 10 < 3 && v % 10 < 3 ? kOnChair : kOnWall; };
  Mesh mesh = WallWith(shreds, false);
  for (MeshVertex& vertex : mesh.vertices) {
    vertex.normal_W = Eigen::Vector3f(noise(random), noise(random), noise(random)).normalized();
  }
  AbsorbIslands({}, &mesh);
  EXPECT_EQ(CountOf(mesh, kSeatLabel), 0);
}

TEST(AbsorbIslands, LeavesUnlabelledSurfaceAlone) {
  const auto hole = [](int u, int v) { return InDisc(u, v, 4) ? Label{} : kOnWall; };
  Mesh mesh = WallWith(hole);
  const int64_t without = CountOf(mesh, SegmentLabel::kNone);
  AbsorbIslands({}, &mesh);
  EXPECT_EQ(CountOf(mesh, SegmentLabel::kNone), without);
  const auto in_nothing = [](int u, int v) { return InDisc(u, v, 4) ? kOnChair : Label{}; };
  EXPECT_EQ(Absorbed(WallWith(in_nothing)), 0);
}

TEST(AbsorbIslands, TakesTheMainSegmentOfAnInstance) {
  // A chair of two segments has an island of the wall's in it.
  const SegmentLabel seat{4};
  Mesh mesh;
  AddSquare(
      60, 0,
      [&](int u, int v) {
        if (InDisc(u, v, 3)) return kOnWall;
        return u < 32 ? kOnChair : Label{seat, kChairInstance};
      },
      &mesh);
  AddSquare(
      60, 5, [](int, int) { return kOnWall; }, &mesh);
  const int64_t seats = CountOf(mesh, seat);
  AbsorbIslands({}, &mesh);
  EXPECT_EQ(CountOf(mesh, kWall), 60 * 60);
  EXPECT_EQ(CountOf(mesh, seat), seats) << "most of its border is with the other";
}

TEST(AbsorbIslands, DoesNotDependOnTheOrderOfTheMesh) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> dice(0, 99);
  std::vector<Label> labels(60 * 60, kOnWall);
  for (Label& label : labels) {
    if (const int roll = dice(random); roll < 20) label = roll < 5 ? kOnGround : kOnChair;
  }
  const Mesh mesh = WallWith([&](int u, int v) { return labels[static_cast<size_t>(60 * v + u)]; });
  Mesh expected = mesh;
  AbsorbIslands({}, &expected);
  EXPECT_LT(CountOf(expected, kSeatLabel), CountOf(mesh, kSeatLabel));

  std::vector<uint32_t> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0u);
  std::shuffle(place.begin(), place.end(), random);
  Mesh shuffled = mesh;
  for (size_t i = 0; i < place.size(); ++i) shuffled.vertices[place[i]] = mesh.vertices[i];
  for (auto& triangle : shuffled.triangles) {
    for (uint32_t& corner : triangle) corner = place[corner];
  }
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  AbsorbIslands({}, &shuffled);
  for (size_t i = 0; i < place.size(); ++i)
    ASSERT_EQ(shuffled.vertices[place[i]].segment, expected.vertices[i].segment) << i;
}

}  // namespace
}  // namespace vismap
