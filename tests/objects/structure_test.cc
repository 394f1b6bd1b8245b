#include "objects/structure.h"

#include <gmock/gmock.h>

#include <numbers>
#include <random>

namespace vismap {
namespace {

using ::testing::ElementsAre;

SurfacePlane Level(double height, double area) {
  return {{1, 2, height}, -Eigen::Vector3d::UnitZ(), 0.9, area};
}

TEST(NameStructure, TellsFloorTableTopCeilingAndWallApart) {
  const SurfacePlane wall{{0, 0, 1}, Eigen::Vector3d::UnitX(), 0.9, 4};
  const SurfacePlane roof{{0, 0, 2}, Eigen::Vector3d(1, 0, 1).normalized(), 0.9, 4};
  const SurfacePlane picture{{0, 0, 1}, Eigen::Vector3d::UnitX(), 0.9, 0.5};
  const std::vector<SurfacePlane> planes{
      Level(5.02, 20), Level(5.74, 0.4), Level(7.6, 20),  wall, roof, picture, Level(5.74, 0.2), {},
      Level(5.1, 0.4), Level(5, 2),      Level(5.01, 0.1)};
  using enum StructureKind;
  EXPECT_THAT(NameStructure(planes, Eigen::Vector3d::UnitZ(), 0, {}),
              ElementsAre(kFloor, kTableTop, kCeiling, kWall, kSloped, kNone, kNone, kNone, kNone,
                          kFloor, kFloor));
}

TEST(NameStructure, WithoutFloorTheLowestThingCounts) {
  const std::vector<SurfacePlane> planes{Level(0.7, 0.8)};
  EXPECT_THAT(NameStructure(planes, Eigen::Vector3d::UnitZ(), 0, {}),
              ElementsAre(StructureKind::kTableTop));
  EXPECT_THAT(NameStructure(planes, Eigen::Vector3d::UnitZ(), 0.6, {}),
              ElementsAre(StructureKind::kNone));
}

/// Points on the rectangle from (x, z) = `low` to `high` at depth y, a centimetre apart, with noise
/// of deviation `noise` along y [m].
std::vector<Eigen::Vector3f> Upright(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                                     double y, double noise) {
  std::mt19937 random(7);
  std::normal_distribution<double> gauss(0, noise > 0 ? noise : 1);
  std::vector<Eigen::Vector3f> points;
  for (double x = low.x(); x < high.x(); x += 0.01) {
    for (double z = low.y(); z < high.y(); z += 0.01)
      points.emplace_back(x, y + (noise > 0 ? gauss(random) : 0), z);
  }
  return points;
}

struct Measured {
  std::vector<SurfacePlane> planes;
  std::vector<SurfaceSpread> spreads;
};
/// Planes and spreads of pieces with one point per square centimetre.
Measured Measure(const std::vector<std::vector<Eigen::Vector3f>>& pieces,
                 const StructureOptions& options) {
  Measured measured;
  for (const auto& points : pieces) {
    measured.planes.push_back(
        FindPlane(points, 1e-4 * static_cast<double>(points.size()), options));
    measured.spreads.push_back(SpreadOf(points));
  }
  return measured;
}

/// The kinds of all pieces after NameFlushPieces. The first piece is structure.
std::vector<StructureKind> NameBeside(StructureKind first,
                                      const std::vector<std::vector<Eigen::Vector3f>>& pieces,
                                      const StructureOptions& options = {}) {
  auto [planes, spreads] = Measure(pieces, options);
  std::vector<StructureKind> kinds(pieces.size(), StructureKind::kNone);
  kinds[0] = first;
  NameFlushPieces(planes, spreads, options, &kinds);
  return kinds;
}

TEST(NameFlushPieces, PiecesOfANoisyWallAreWallAndWhatStandsOutIsNot) {
  const std::vector<std::vector<Eigen::Vector3f>> pieces{
      Upright({0, 0}, {2, 1}, 0, 0.015),            // the wall
      Upright({2.1, 0.2}, {2.4, 0.5}, 0.01, 0.02),  // beside it, noisier and a little off
      Upright({2.1, 0.6}, {2.4, 0.8}, 0.05, 0.015),
      Upright({4, 0}, {4.3, 0.5}, 0, 0.015),  // in its plane, but two metres away
  };
  using enum StructureKind;
  EXPECT_THAT(NameBeside(kWall, pieces), ElementsAre(kWall, kWall, kNone, kNone));
  EXPECT_THAT(NameBeside(kWall, pieces, {.flush_roughness = 5}),
              ElementsAre(kWall, kWall, kWall, kNone));
  EXPECT_THAT(NameBeside(kWall, pieces, {.flush_gap_m = 2.5}),
              ElementsAre(kWall, kWall, kNone, kWall));
  EXPECT_THAT(NameBeside(kWall, pieces, {.flush_roughness = 0}),
              ElementsAre(kWall, kNone, kNone, kNone));
  EXPECT_THAT(NameBeside(kTableTop, pieces), ElementsAre(kTableTop, kNone, kNone, kNone))
      << "flat things lie on table tops";
}

TEST(NameFlushPieces, OnAnExactWallAThinPictureIsAThing) {
  const std::vector<std::vector<Eigen::Vector3f>> pieces{Upright({0, 0}, {2, 1}, 0, 0),
                                                         Upright({2, 0}, {2.3, 0.5}, 0.001, 0),
                                                         Upright({2, 0.5}, {2.3, 0.8}, 0.015, 0)};
  using enum StructureKind;
  EXPECT_THAT(NameBeside(kWall, pieces), ElementsAre(kWall, kWall, kNone));
}

TEST(NameFlushPieces, TheClosestPlaneDecidesWhateverTheOrder) {
  const auto near = Upright({0, 0}, {2, 1}, 0.01, 0.015);
  const auto far = Upright({0, 0}, {2, 1}, -0.015, 0.015);
  const auto piece = Upright({2, 0}, {2.3, 0.5}, 0.01, 0.015);
  for (const bool near_first : {true, false}) {
    std::vector<SurfacePlane> planes;
    std::vector<SurfaceSpread> spreads;
    for (const auto& points : {near_first ? near : far, near_first ? far : near, piece}) {
      planes.push_back(FindPlane(points, 1, {}));
      spreads.push_back(SpreadOf(points));
    }
    using enum StructureKind;
    std::vector<StructureKind> kinds{near_first ? kWall : kSloped, near_first ? kSloped : kWall,
                                     kNone};
    NameFlushPieces(planes, spreads, {}, &kinds);
    EXPECT_EQ(kinds[2], kWall);
  }
}

/// The kinds of pieces after JoinFlushAreas. z is up.
std::vector<StructureKind> NameJoined(const std::vector<std::vector<Eigen::Vector3f>>& pieces,
                                      const StructureOptions& options = {}) {
  auto [planes, spreads] = Measure(pieces, options);
  JoinFlushAreas(spreads, options, &planes);
  return NameStructure(planes, Eigen::Vector3d::UnitZ(), 0, options);
}

TEST(JoinFlushAreas, PiecesOfAWallAreAWallTogether) {
  const auto left = Upright({0, 0}, {1, 0.8}, 0, 0.01);
  const auto right = Upright({1.2, 0}, {1.8, 0.8}, 0.005, 0.01);
  const auto before = Upright({1.2, 0}, {1.8, 0.8}, -0.06, 0.01);
  const auto far = Upright({3, 0}, {3.6, 0.8}, 0, 0.01);
  using enum StructureKind;
  EXPECT_THAT(NameJoined({left, right}), ElementsAre(kWall, kWall));
  EXPECT_THAT(NameJoined({right, left}), ElementsAre(kWall, kWall));
  EXPECT_THAT(NameJoined({left, before}), ElementsAre(kNone, kNone));
  EXPECT_THAT(NameJoined({left, far}), ElementsAre(kNone, kNone));
  EXPECT_THAT(NameJoined({left, right}, {.flush_roughness = 0}), ElementsAre(kNone, kNone));
}

TEST(JoinFlushAreas, BoxesOfOneHeightAreNoTableTop) {
  std::vector<std::vector<Eigen::Vector3f>> lids{Upright({0, 0}, {0.5, 0.5}, 0, 0.005),
                                                 Upright({0.6, 0}, {1.1, 0.5}, 0, 0.005)};
  for (auto& lid : lids) {
    for (Eigen::Vector3f& p : lid) p = {p.x(), p.z(), 0.8F + p.y()};
  }
  EXPECT_THAT(NameJoined(lids), ElementsAre(StructureKind::kNone, StructureKind::kNone));
}

TEST(FindPlane, RoughnessIsTheNoise) {
  EXPECT_NEAR(FindPlane(Upright({0, 0}, {1, 1}, 3, 0.01), 1, {}).roughness, 0.01, 5e-4);
  EXPECT_NEAR(FindPlane(Upright({0, 0}, {1, 1}, 3, 0), 1, {}).roughness, 0, 1e-6);
}

TEST(SpannedArea, OfAPlateIsItsAreaHoweverItIsTurned) {
  std::vector<Eigen::Vector3f> plate = Upright({0, 0}, {0.6, 0.4}, 1, 0);
  EXPECT_NEAR(SpannedArea(SpreadOf(plate)), 0.24, 0.24 * 0.02);
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
  for (Eigen::Vector3f& p : plate) p = turn * p;
  EXPECT_NEAR(SpannedArea(SpreadOf(plate)), 0.24, 0.24 * 0.02);
}

TEST(SpannedArea, OfABodyIsLessThanItsSurfaceAndOfSpecksFarMore) {
  std::vector<Eigen::Vector3f> ball;
  for (double polar = 0.05; polar < std::numbers::pi; polar += 0.05) {
    const double ring = 0.1 * std::sin(polar);
    for (double turn = 0; turn < 2 * std::numbers::pi; turn += 0.005 / ring)
      ball.emplace_back(ring * std::cos(turn), ring * std::sin(turn), 0.1 * std::cos(polar));
  }
  EXPECT_LT(SpannedArea(SpreadOf(ball)), 0.5 * 4 * std::numbers::pi * 0.01);
  std::vector<Eigen::Vector3f> specks = Upright({0, 0}, {0.05, 0.05}, 0, 0);
  const size_t one = specks.size();
  for (size_t i = 0; i < one; ++i) specks.push_back(specks[i] + Eigen::Vector3f(0.5F, 0, 0.1F));
  for (size_t i = 0; i < one; ++i) specks.push_back(specks[i] + Eigen::Vector3f(0.2F, 0, 0.4F));
  EXPECT_GT(SpannedArea(SpreadOf(specks)), 10 * 3 * 0.0025);
}

}  // namespace
}  // namespace vismap
