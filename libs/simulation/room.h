#pragma once

#include <vector>

#include "geometry/pose.h"
#include "simulation/scene.h"

namespace vismap {

/// The built-in room: 5 x 4 x 2.6 m, z up, with the centre of the floor at the origin. It has a
/// floor, a ceiling and four walls (solids outside of the free space), 12 objects with COCO classes
/// and 6 without. It is always the same.
Scene MakeRoom();

/// `count` camera poses T_W_C on a smooth, closed tour of the room at eye height, without
/// collisions: one round that looks across the table, and one that looks at the walls. With more
/// poses, the steps on the same tour are smaller.
std::vector<Pose> MakeRoomTour(int count);

}  // namespace vismap
