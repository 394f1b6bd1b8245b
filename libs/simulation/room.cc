#include "simulation/room.h"

#include <array>

#include "base/require.h"
#include "simulation/camera_path.h"
#include "simulation/models.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

/// Adds floor, ceiling and walls as slabs outside of the free space.
void AddStructure(Furniture* room) {
  constexpr double kX = 2.5, kY = 2.0, kHeight = 2.6, kThick = 0.1;
  const auto add = [&](const char* name, Rgb8 color, const Vector3d& center, const Vector3d& half) {
    room->Put(Builder(room->Structure(name, color), {}).Box(center, half));
  };
  const double middle = kHeight / 2, t = kThick;
  add("floor", {150, 120, 90}, {0, 0, -t}, {kX + 2 * t, kY + 2 * t, t});
  add("ceiling", {230, 230, 225}, {0, 0, kHeight + t}, {kX + 2 * t, kY + 2 * t, t});
  add("wall", {200, 205, 190}, {-kX - t, 0, middle}, {t, kY + 2 * t, middle});
  add("wall", {190, 205, 205}, {kX + t, 0, middle}, {t, kY + 2 * t, middle});
  add("wall", {210, 200, 185}, {0, -kY - t, middle}, {kX, t, middle});
  add("wall", {205, 195, 205}, {0, kY + t, middle}, {kX, t, middle});
}

void AddLargeThings(Furniture* room) {
  room->Put(Table(room->Known("dining table", 67, {150, 95, 50}), {{0, 0, 0}, kAhead}));
  room->Put(Chair(room->Known("chair", 62, {60, 90, 160}), {{-0.85, 0.05, 0}, kLittle}));
  room->Put(Chair(room->Known("chair", 62, {60, 140, 90}), {{0.85, -0.1, 0}, kBack}));
  room->Put(Couch(room->Known("couch", 63, {150, 60, 60}), {{-0.9, -1.58, 0}, kAhead}));
  room->Put(
      Block(room->Unknown("cabinet", {220, 215, 200}), {{0.2, 1.78, 0}, kAhead}, {1.5, 0.4, 0.5}));
  room->Put(Television(room->Known("tv", 72, {25, 25, 30}), {{0, 1.85, 0.5}, kAhead}));
  room->Put(PottedPlant(room->Known("potted plant", 64, {50, 120, 50}), {{2.05, 1.55, 0}, kAhead}));
  room->Put(Lamp(room->Unknown("lamp", {235, 200, 120}), {{2.1, -1.6, 0}, kAhead}));
  room->Put(
      Block(room->Unknown("box", {180, 140, 95}), {{-2.0, 1.45, 0}, kLittle}, {0.6, 0.5, 0.44}));
  room->Put(Block(room->Unknown("small box", {200, 165, 120}), {{-2.0, 1.45, 0.44}, kMuch},
                  {0.32, 0.28, 0.24}));
  room->Put(
      Block(room->Unknown("speaker", {90, 90, 95}), {{1.3, -1.75, 0}, kAhead}, {0.26, 0.3, 0.9}));
  room->Put(Builder(room->Unknown("pillow", {230, 190, 60}), {{-1.3, -1.68, 0.42}, kAhead})
                .Ellipsoid({0, 0, 0.17}, {0.22, 0.11, 0.18}));
}

void AddSmallThings(Furniture* room) {
  const double table = 0.76, cabinet = 0.5;
  room->Put(Backpack(room->Known("backpack", 27, {40, 60, 120}), {{2.25, 0.55, 0}, kLeft}));
  room->Put(Cup(room->Known("cup", 47, {235, 235, 240}), {{0.3, 0.12, table}, kAhead}));
  room->Put(Book(room->Known("book", 84, {170, 40, 50}), {{-0.25, -0.12, table}, kMuch}));
  room->Put(Bottle(room->Known("bottle", 44, {30, 110, 70}), {{-0.2, 0.2, table}, kAhead}));
  room->Put(Bowl(room->Known("bowl", 51, {90, 160, 200}), {{0.15, -0.2, table}, kAhead}));
  room->Put(Vase(room->Known("vase", 86, {120, 70, 150}), {{0.75, 1.75, cabinet}, kAhead}));
}

}  // namespace

Scene MakeRoom() {
  Scene scene{"room", {}};
  Furniture room(&scene.objects);
  AddStructure(&room);
  AddLargeThings(&room);
  AddSmallThings(&room);
  return scene;
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
  for (const Heading at : kRound) {  // from the edges of the room, looking across the table
    eyes.emplace_back(1.7 * at.c, 1.25 * at.s, 1.55);
    targets.emplace_back(-0.5 * at.c, -0.4 * at.s, 0.75);
  }
  for (const Heading at : kRound) {  // from the middle, looking at the walls
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
