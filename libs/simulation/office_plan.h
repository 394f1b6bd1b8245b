#pragma once

#include <vector>

#include "simulation/builder.h"

// The floor plan of the office: what stands where before anything is furnished. All in W [m]: z up,
// floor at z = 0, the floor's centre at the origin.
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
inline constexpr double kHalfX = 20, kHalfY = 12.5;   ///< the floor's outer walls
inline constexpr double kHeight = 2.6;                ///< of the ceiling
inline constexpr double kOuterX = 15.5, kOuterY = 8;  ///< corridor's walls to the outer rooms
inline constexpr double kInnerX = 13.5, kInnerY = 6;  ///< corridor's walls to the core
inline constexpr double kWall = 0.06;                 ///< half a wall's thickness
inline constexpr double kPathX = 14.5, kPathY = 7;    ///< middle of the corridor
}  // namespace office

enum class OfficeRoomKind { kOffice, kOpenPlan, kOpenPlanInCore, kMeetingRoom, kKitchen };

/// A room behind its door. Its frame has the origin in the middle of the door, on the floor at the
/// room's side of the wall; x along the wall, y into the room.
struct OfficeRoom {
  OfficeRoomKind kind = OfficeRoomKind::kOffice;
  Place place;
  double left = 0, right = 0;  ///< x of the room's side walls, left < 0 < right
  double depth = 0;            ///< y of the wall opposite
};

/// An opening up to 2.1 m in the wall that its centre lies in.
struct Opening {
  double x = 0, y = 0;
  double width = 1;
};

/// A straight wall along an axis, with the given centre line.
struct OfficeWall {
  bool along_x = true;
  double at = 0;  ///< the other coordinate
  double from = 0, to = 0;
};

std::vector<OfficeRoom> OfficeRooms();
std::vector<Opening> OfficeOpenings();
/// Those within the outer walls.
std::vector<OfficeWall> OfficeWalls();
/// The openings in a wall, in ascending order along it.
std::vector<Opening> OpeningsIn(const OfficeWall& wall);

}  // namespace vismap
