#include "simulation/office_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismap {
namespace {

using namespace office;

constexpr double kDoor = 1.0, kPassage = 2.4;

/// A side of the corridor with a row of outer rooms.
struct Side {
  Heading heading;  // x of the rooms' frames: along the corridor's wall, with y into the rooms
  bool along_x;     // whether the wall is along x of W
  double wall;      // y of the wall in W, or x if it is along y [m]
  double depth;     // of the rooms [m]
};

/// A room of a row: the coordinates of its two side walls and of its door along the wall, in W [m].
struct Cell {
  double low, high, door;
  OfficeRoomKind kind = OfficeRoomKind::kOffice;
};

constexpr double kDepthY = kHalfY - kOuterY - kWall, kDepthX = kHalfX - kOuterX - kWall;
constexpr Side kNorth{kAhead, true, kOuterY, kDepthY}, kSouth{kBack, true, -kOuterY, kDepthY},
    kEast{kRight, false, kOuterX, kDepthX}, kWest{kLeft, false, -kOuterX, kDepthX};

constexpr std::array<Cell, 8> kNorthCells{{{-20, -13, -14.2},
                                           {-13, -8.67, -10.83},
                                           {-8.67, -4.33, -6.5},
                                           {-4.33, 0, -2.17},
                                           {0, 4.33, 2.17},
                                           {4.33, 8.67, 6.5},
                                           {8.67, 13, 10.83},
                                           {13, 20, 14.2}}};
constexpr std::array<Cell, 6> kSouthCells{{{-20, -13, -14.2},
                                           {-13, -8.67, -10.83},
                                           {-8.67, -4.33, -6.5},
                                           {-4.33, 8.67, 2.17, OfficeRoomKind::kOpenPlan},
                                           {8.67, 13, 10.83},
                                           {13, 20, 14.2}}};
constexpr std::array<Cell, 3> kEastCells{{{-8, -2.67, -5.33}, {-2.67, 2.67, 0}, {2.67, 8, 5.33}}};
constexpr std::array<Cell, 3> kWestCells{{{-8, -1.3, -3.5}, {-1.3, 3.35, 1.02}, {3.35, 8, 5.67}}};

double WidthOf(OfficeRoomKind kind) { return kind == OfficeRoomKind::kOffice ? kDoor : kPassage; }

/// The coordinate of a wall's surface. The outer walls stand outside of their line, all others are
/// centred on it.
double FaceOf(double line, double toward) {
  return std::abs(line) == kHalfX ? line : line + toward * kWall;
}

OfficeRoom RoomOf(const Side& side, const Cell& cell) {
  const Place door{side.along_x ? Eigen::Vector3d(cell.door, side.wall, 0)
                                : Eigen::Vector3d(side.wall, cell.door, 0),
                   side.heading};
  const double low = FaceOf(cell.low, 1) - cell.door, high = FaceOf(cell.high, -1) - cell.door;
  const bool forward = side.heading.c + side.heading.s >
                       0;  // whether x of the room has the direction of x or y of W
  return {cell.kind, door.At({0, kWall, 0}), forward ? low : -high, forward ? high : -low,
          side.depth};
}

template <typename Cells>
void AddRooms(const Side& side, const Cells& cells, std::vector<OfficeRoom>* rooms) {
  for (const Cell& cell : cells) rooms->push_back(RoomOf(side, cell));
}

template <typename Cells>
void AddDoors(const Side& side, const Cells& cells, std::vector<Opening>* openings) {
  for (const Cell& cell : cells) {
    openings->push_back({side.along_x ? cell.door : side.wall, side.along_x ? side.wall : cell.door,
                         WidthOf(cell.kind)});
  }
}

/// Adds the walls between the rooms of a row, from the corridor's wall to the outer wall.
template <typename Cells>
void AddPartitions(const Side& side, const Cells& cells, std::vector<OfficeWall>* walls) {
  const double sign = side.wall > 0 ? 1 : -1;
  const double near = side.wall + sign * kWall, far = near + sign * side.depth;
  for (size_t i = 1; i < cells.size(); ++i) {
    walls->push_back({!side.along_x, cells[i].low, std::min(near, far), std::max(near, far)});
  }
}

}  // namespace

std::vector<OfficeRoom> OfficeRooms() {
  std::vector<OfficeRoom> rooms;
  AddRooms(kSouth, kSouthCells, &rooms);
  AddRooms(kEast, kEastCells, &rooms);
  AddRooms(kNorth, kNorthCells, &rooms);
  AddRooms(kWest, kWestCells, &rooms);
  const double face = kInnerY - kWall, plan = 4.75 - kWall, middle = 4 - kWall;
  const auto add = [&](OfficeRoomKind kind, const Place& place, double half, double depth) {
    rooms.push_back({kind, place, -half, half, depth});
  };
  add(OfficeRoomKind::kOpenPlanInCore, {{-8.75, -face, 0}, kAhead}, plan, 2 * face);
  add(OfficeRoomKind::kOpenPlanInCore, {{8.75, -face, 0}, kAhead}, plan, 2 * face);
  add(OfficeRoomKind::kKitchen, {{0, -face, 0}, kAhead}, middle, face - kWall);
  add(OfficeRoomKind::kMeetingRoom, {{0, face, 0}, kBack}, middle, face - kWall);
  return rooms;
}

std::vector<Opening> OfficeOpenings() {
  std::vector<Opening> openings;
  AddDoors(kSouth, kSouthCells, &openings);
  AddDoors(kEast, kEastCells, &openings);
  AddDoors(kNorth, kNorthCells, &openings);
  AddDoors(kWest, kWestCells, &openings);
  for (const double x : {-8.75, 8.75}) {
    for (const double y : {-kInnerY, kInnerY}) openings.push_back({x, y, kPassage});
  }
  openings.push_back({0, -kInnerY, kPassage});
  openings.push_back({0, kInnerY, kDoor});
  return openings;
}

std::vector<OfficeWall> OfficeWalls() {
  std::vector<OfficeWall> walls;
  const double outer = kOuterY - kWall, inner = kInnerY - kWall;
  for (const double sign : {-1.0, 1.0}) {
    walls.push_back({true, sign * kOuterY, -kHalfX, kHalfX});
    walls.push_back({true, sign * kInnerY, -kInnerX - kWall, kInnerX + kWall});
    walls.push_back({false, sign * kOuterX, -outer, outer});
    walls.push_back({false, sign * kInnerX, -inner, inner});
    walls.push_back({false, sign * 4, -inner, inner});
  }
  walls.push_back({true, 0, -4 + kWall, 4 - kWall});
  AddPartitions(kSouth, kSouthCells, &walls);
  AddPartitions(kEast, kEastCells, &walls);
  AddPartitions(kNorth, kNorthCells, &walls);
  AddPartitions(kWest, kWestCells, &walls);
  return walls;
}

std::vector<Opening> OpeningsIn(const OfficeWall& wall) {
  std::vector<Opening> found;
  for (const Opening& opening : OfficeOpenings()) {
    const double along = wall.along_x ? opening.x : opening.y;
    if ((wall.along_x ? opening.y : opening.x) == wall.at && along > wall.from && along < wall.to) {
      found.push_back(opening);
    }
  }
  std::sort(found.begin(), found.end(), [&](const Opening& a, const Opening& b) {
    return wall.along_x ? a.x < b.x : a.y < b.y;
  });
  return found;
}

}  // namespace vismap
