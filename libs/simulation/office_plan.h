#pragma once

#include <vector>

#include "simulation/builder.h"

// The floor plan of the office: rooms, walls and openings, without furniture. All coordinates are
// in W [m]: z up, with the centre of the floor at the origin.
//
//   +--------+----+----+----+----+----+----+--------+   y = 12.5
//   |        |    |    |    |    |    |    |        |   offices
//   |  +--------------------------------------+     |   y = 8
//   |--|  +----------+---------+----------+   |-----|   corridor, 2 m
//   |  |  |  open    | meeting |  open    |   |     |
//   |--|  |  plan    | kitchen |  plan    |   |     |
//   |  |  +----------+---------+----------+   |-----|
//   |  +--------------------------------------+     |   y = -8
//   |        |    |    |   open plan  |    |        |
//   +--------+----+----+--------------+----+--------+   y = -12.5, x = -20 .. 20

namespace vismap {

namespace office {
inline constexpr double kHalfX = 20, kHalfY = 12.5;   ///< outer walls of the storey
inline constexpr double kHeight = 2.6;                ///< height of the ceiling
inline constexpr double kOuterX = 15.5, kOuterY = 8;  ///< walls between corridor and outer rooms
inline constexpr double kInnerX = 13.5, kInnerY = 6;  ///< walls between corridor and core
inline constexpr double kWall = 0.06;                 ///< half of a wall's thickness
inline constexpr double kPathX = 14.5, kPathY = 7;    ///< middle of the corridor
}  // namespace office

enum class OfficeRoomKind { kOffice, kOpenPlan, kOpenPlanInCore, kMeetingRoom, kKitchen };

/// A room. The origin of its frame is in the middle of the door, on the floor and at the room's
/// side of the wall; x is along the wall, y into the room.
struct OfficeRoom {
  OfficeRoomKind kind = OfficeRoomKind::kOffice;
  Place place;
  double left = 0, right = 0;  ///< x of the side walls, left < 0 < right
  double depth = 0;            ///< y of the wall opposite the door
};

/// An opening of 2.1 m height in the wall that contains its centre (x, y).
struct Opening {
  double x = 0, y = 0;
  double width = 1;
};

/// A straight wall along an axis of W, given by its centre line.
struct OfficeWall {
  bool along_x = true;
  double at = 0;            ///< y of the centre line, or x if it is along y
  double from = 0, to = 0;  ///< ends along the wall
};

std::vector<OfficeRoom> OfficeRooms();
std::vector<Opening> OfficeOpenings();
/// The walls inside of the outer walls.
std::vector<OfficeWall> OfficeWalls();
/// The openings in a wall, in ascending order along it.
std::vector<Opening> OpeningsIn(const OfficeWall& wall);

}  // namespace vismap
