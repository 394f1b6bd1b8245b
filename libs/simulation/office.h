#pragma once

#include <vector>

#include "geometry/pose.h"
#include "simulation/scene.h"

namespace vismap {

/// The built-in office: one floor of 40 x 25 x 2.6 m, 1000 m^2, z up, floor at z = 0, centre of the
/// floor at the origin: a ring of corridors between offices outside and open-plan areas, a meeting
/// room and a kitchen inside (see office_plan.h). 953 objects of 2100 shapes, with COCO classes or
/// without. Always the same.
Scene MakeOffice();

/// `count` camera poses: one walk around the whole corridor at 1.5 m height with eight rooms
/// visited on the way, 126 m, through doors only, looking ahead and a little down. Closed, yet the
/// end sees little of what the beginning saw, for it begins at a corner; both see a corridor and an
/// office, and about as much of their surface. Steps are alike: the more the view turns, the
/// shorter they are.
std::vector<Pose> MakeOfficeWalk(int count);

}  // namespace vismap
