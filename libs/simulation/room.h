#pragma once

#include <vector>

#include "geometry/pose.h"
#include "simulation/scene.h"

namespace vismap {

/// The built-in room: 5 x 4 x 2.6 m, z up, floor at z = 0, centre of the floor at the origin;
/// floor, ceiling and four walls (solid, outside the free space), 12 objects with COCO classes and
/// 6 without. Always the same.
Scene MakeRoom();

/// `count` camera poses in the room: a smooth closed tour, once across the table, once along the
/// walls, at eye height, free of collisions. More poses make smaller steps on the same tour.
std::vector<Pose> MakeRoomTour(int count);

}  // namespace vismap
