#include "simulation/office.h"

#include "simulation/office_plan.h"
#include "simulation/office_rooms.h"
#include "simulation/office_stock.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using namespace office;

/// Adds floor, ceiling and outer walls as slabs outside of the free space.
void AddShell(Furniture* office) {
  constexpr double t = 0.1, kMiddle = 0.5 * kHeight;
  const auto add = [&](const char* name, Rgb8 color, const Vector3d& center, const Vector3d& half) {
    office->Put(Builder(office->Structure(name, color), {}).Box(center, half));
  };
  add("floor", {140, 135, 130}, {0, 0, -t}, {kHalfX + 2 * t, kHalfY + 2 * t, t});
  add("ceiling", {230, 230, 225}, {0, 0, kHeight + t}, {kHalfX + 2 * t, kHalfY + 2 * t, t});
  add("wall", {200, 205, 190}, {-kHalfX - t, 0, kMiddle}, {t, kHalfY + 2 * t, kMiddle});
  add("wall", {190, 205, 205}, {kHalfX + t, 0, kMiddle}, {t, kHalfY + 2 * t, kMiddle});
  add("wall", {210, 200, 185}, {0, -kHalfY - t, kMiddle}, {kHalfX, t, kMiddle});
  add("wall", {205, 195, 205}, {0, kHalfY + t, kMiddle}, {kHalfX, t, kMiddle});
}

/// Adds a wall as one object: the pieces between its openings, and the lintels above the openings.
void AddWall(const OfficeWall& wall, Furniture* office) {
  constexpr double kLintel = 2.1;
  Builder builder(office->Structure("wall", {205, 205, 198}), {});
  const auto piece = [&](double from, double to, double bottom) {
    const double half = 0.5 * (to - from), up = 0.5 * (kHeight - bottom);
    const double along = 0.5 * (from + to), z = 0.5 * (bottom + kHeight);
    if (wall.along_x) builder.Box({along, wall.at, z}, {half, kWall, up});
    if (!wall.along_x) builder.Box({wall.at, along, z}, {kWall, half, up});
  };
  double from = wall.from;
  for (const Opening& opening : OpeningsIn(wall)) {
    const double middle = wall.along_x ? opening.x : opening.y;
    const double begin = middle - 0.5 * opening.width, end = middle + 0.5 * opening.width;
    piece(from, begin, 0);
    piece(begin, end, kLintel);
    from = end;
  }
  piece(from, wall.to, 0);
  office->Put(builder);
}

void FurnishCorridors(OfficeStock* stock) {
  for (const double sign : {-1.0, 1.0}) {
    FurnishCorridor({true, sign * kOuterY, -kHalfX, kHalfX}, -sign, -kInnerX, kInnerX, stock);
    FurnishCorridor({true, sign * kInnerY, -kInnerX, kInnerX}, sign, -kInnerX, kInnerX, stock);
    FurnishCorridor({false, sign * kOuterX, -kOuterY, kOuterY}, -sign, -kInnerY, kInnerY, stock);
    FurnishCorridor({false, sign * kInnerX, -kInnerY, kInnerY}, sign, -kInnerY, kInnerY, stock);
  }
}

}  // namespace

Scene MakeOffice() {
  constexpr uint64_t kSeed = 1000;
  Scene scene{"office", {}};
  Furniture office(&scene.objects);
  AddShell(&office);
  for (const OfficeWall& wall : OfficeWalls()) AddWall(wall, &office);
  uint64_t number = 0;
  for (const OfficeRoom& room : OfficeRooms()) {
    OfficeStock stock(&office, Dice(Mix(kSeed, ++number)));
    FurnishRoom(room, &stock);
  }
  OfficeStock stock(&office, Dice(Mix(kSeed, 0)));
  FurnishCorridors(&stock);
  return scene;
}

}  // namespace vismap
