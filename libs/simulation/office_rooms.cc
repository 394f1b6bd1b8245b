#include "simulation/office_rooms.h"

#include <algorithm>
#include <cmath>

namespace vismap {
namespace {

constexpr double kGap = 0.01;  // between furniture and wall [m]

/// Furnishes one side of an office. `side` is -1 or 1 (sign of x), `reach` is the distance of the
/// side wall from the door [m].
void FurnishOfficeSide(const OfficeRoom& room, double side, double reach, OfficeStock* stock) {
  const auto at = [&](double x, double y, const Heading& heading) {
    return room.place.At({side * x, y, 0}, heading);
  };
  const Heading to_wall = side < 0 ? kLeft : kRight, from_wall = side < 0 ? kRight : kLeft;
  if (reach > 1.5) stock->Workplace(at(reach - 0.4 - kGap, 2.9, to_wall));
  if (reach > 4) stock->TableForTwo(at(0.5 * reach, 2.2, kLeft));
  const double height = stock->dice().Chance(0.5) ? 0.9 : 1.9;
  stock->Cabinet(at(reach - 0.2 - kGap, 0.95, from_wall), {0.9, 0.4, height});
  const Place corner = at(reach - 0.3, room.depth - 0.3, kAhead);
  switch (stock->dice().Of(4)) {
    case 0:
      return stock->Boxes(corner);
    case 1:
      return stock->Lamp(corner);
    case 2:
      return stock->Backpack(corner);
    default:
      return stock->Plant(corner);
  }
}

void FurnishOffice(const OfficeRoom& room, OfficeStock* stock) {
  FurnishOfficeSide(room, -1, -room.left, stock);
  FurnishOfficeSide(room, 1, room.right, stock);
  const Place back = room.place.At({0, room.depth, 0}, kBack);
  stock->Whiteboard(back);
  if (stock->dice().Chance(0.5) && std::min(-room.left, room.right) > 1.5) {
    stock->Couch(back.At({0, 0.45, 0}));
  }
}

void FurnishOpenPlan(const OfficeRoom& room, OfficeStock* stock) {
  for (const double x : {-4.3, 0.0, 4.3}) {
    stock->WorkplacesForFour(room.place.At({x, 2.75, 0}));
  }
  for (const double side : {-1.0, 1.0}) {
    stock->Plant(room.place.At({side * 1.75, 0.35, 0}));
    stock->Cabinet(room.place.At({side * 3.2, 0.2 + kGap, 0}), {0.9, 0.4, 0.9});
    stock->Boxes(room.place.At({side * 2.15, 3.9, 0}));
  }
}

void FurnishOpenPlanInCore(const OfficeRoom& room, OfficeStock* stock) {
  for (const double x : {-2.75, 2.75}) {
    for (const double y : {2.2, 5.94, 9.68}) {
      stock->WorkplacesForFour(room.place.At({x, y, 0}));
    }
    for (const double y : {4.07, 7.81}) {
      const SceneObject pillar = stock->office().Unknown("pillar", {190, 190, 185});
      stock->Block(pillar, room.place.At({x, y, 0}), {0.36, 0.36, 2.6});
    }
    for (const double y : {0.35, room.depth - 0.35}) {
      stock->Plant(room.place.At({x < 0 ? -1.75 : 1.75, y, 0}));
    }
  }
  for (const double y : {2.2, 5.94, 9.68}) {
    stock->Whiteboard(room.place.At({room.left, y, 0}, kRight));
    stock->Picture(room.place.At({room.right, y, 0}, kLeft));
  }
}

void FurnishMeetingRoom(const OfficeRoom& room, OfficeStock* stock) {
  const Place table = room.place.At({0, 4, 0});
  for (const double x : {-1.21, 0.0, 1.21}) {
    stock->TableForTwo(table.At({x, 0, 0}, kLeft));
    if (x != 0) stock->Laptop(table.At({x, -0.25, 0.76}));
  }
  const SceneObject board = stock->office().Unknown("sideboard", {170, 130, 95});
  const Place back = room.place.At({0, room.depth - 0.2 - kGap, 0}, kBack);
  stock->Block(board, back, {1.8, 0.4, 0.6});
  stock->Television(back.At({0, 0, 0.6}));
  for (const double side : {-1.0, 1.0}) {
    stock->Plant(room.place.At({side * 3.5, room.depth - 0.4, 0}));
    stock->Cabinet(room.place.At({side * 3.0, 0.2 + kGap, 0}), {0.9, 0.4, 0.9});
    stock->Couch(room.place.At({side * (room.right - 0.41), 2.9, 0}, side < 0 ? kRight : kLeft));
  }
  stock->Whiteboard(room.place.At({room.left, 1.1, 0}, kRight));
  stock->Whiteboard(room.place.At({room.right, 1.1, 0}, kLeft));
}

void FurnishKitchen(const OfficeRoom& room, OfficeStock* stock) {
  Furniture& office = stock->office();
  const Place back = room.place.At({0, room.depth - 0.3 - kGap, 0}, kBack);
  stock->Block(office.Unknown("counter", {225, 220, 205}), back, {3.6, 0.6, 0.9});
  const Place top = back.At({0, 0, 0.9});
  stock->Block(office.Known("microwave", 78, {190, 190, 195}), top.At({-1.4, 0, 0}),
               {0.5, 0.36, 0.3});
  stock->Block(office.Known("toaster", 80, {200, 80, 70}), top.At({-0.8, 0, 0}), {0.3, 0.2, 0.2});
  stock->Block(office.Unknown("coffee machine", {60, 55, 55}), top.At({0.9, 0, 0}),
               {0.35, 0.4, 0.4});
  for (const double x : {-0.4, -0.2, 0.0}) stock->Cup(top.At({x, 0.1, 0}));
  for (const double x : {0.25, 0.45}) stock->Bottle(top.At({x, -0.1, 0}));
  stock->Block(office.Known("refrigerator", 82, {230, 232, 235}), back.At({2.3, 0, 0}),
               {0.7, 0.6, 1.8});
  stock->Bin(back.At({-2.1, 0, 0}));
  for (const double side : {-1.0, 1.0}) {
    for (const double y : {1.4, 3.2}) {
      stock->TableForTwo(room.place.At({side * 2.4, y, 0}));
    }
    stock->Plant(room.place.At({side * 3.5, 5.3, 0}));
    stock->Picture(room.place.At({side * room.right, 2.3, 0}, side < 0 ? kRight : kLeft));
  }
}

/// Whether no opening of the wall is near the position `along` it.
bool IsClear(const OfficeWall& wall, double along, double half_width) {
  constexpr double kMargin = 0.3;
  for (const Opening& opening : OpeningsIn(wall)) {
    const double distance = std::abs((wall.along_x ? opening.x : opening.y) - along);
    if (distance < 0.5 * opening.width + half_width + kMargin) return false;
  }
  return true;
}

/// Puts one random object in front of the wall at y = 0 of the place.
void PutAtCorridorWall(const Place& place, OfficeStock* stock) {
  switch (stock->dice().Of(9)) {
    case 0:
    case 1:
      return stock->Cabinet(place.At({0, 0.2 + kGap, 0}), {0.8, 0.38, 0.9});
    case 2:
      return stock->Plant(place.At({0, 0.32, 0}));
    case 3:
      return stock->Bin(place.At({0, 0.2, 0}));
    case 4:
      return stock->Boxes(place.At({0, 0.24, 0}));
    case 5:
      return stock->Clock(place);
    case 6:
      stock->Picture(place);
      return stock->Block(stock->office().Known("bench", 15, {150, 115, 80}),
                          place.At({0, 0.2 + kGap, 0}), {1.1, 0.38, 0.45});
    case 7:
      return stock->Block(stock->office().Known("suitcase", 33, {120, 60, 80}),
                          place.At({0, 0.15 + kGap, 0}), {0.45, 0.25, 0.65});
    default:
      return stock->Picture(place);
  }
}

}  // namespace

void FurnishRoom(const OfficeRoom& room, OfficeStock* stock) {
  switch (room.kind) {
    case OfficeRoomKind::kOffice:
      return FurnishOffice(room, stock);
    case OfficeRoomKind::kOpenPlan:
      return FurnishOpenPlan(room, stock);
    case OfficeRoomKind::kOpenPlanInCore:
      return FurnishOpenPlanInCore(room, stock);
    case OfficeRoomKind::kMeetingRoom:
      return FurnishMeetingRoom(room, stock);
    case OfficeRoomKind::kKitchen:
      return FurnishKitchen(room, stock);
  }
}

void FurnishCorridor(const OfficeWall& wall, double toward, double from, double to,
                     OfficeStock* stock) {
  constexpr double kStep = 1.6, kHalfWidth = 0.55;
  const double face = wall.at + toward * office::kWall;
  Heading heading;
  if (wall.along_x) heading = toward > 0 ? kAhead : kBack;
  if (!wall.along_x) heading = toward > 0 ? kRight : kLeft;
  for (double along = from + 0.8; along < to - 0.6; along += kStep) {
    if (!IsClear(wall, along, kHalfWidth)) continue;
    const Eigen::Vector3d point =
        wall.along_x ? Eigen::Vector3d(along, face, 0) : Eigen::Vector3d(face, along, 0);
    PutAtCorridorWall({point, heading}, stock);
  }
}

}  // namespace vismap
