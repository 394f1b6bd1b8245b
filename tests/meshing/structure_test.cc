#include "meshing/structure.h"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace vismap
