#pragma once

#include <vector>

#include "geometry/pose.h"
#include "simulation/scene.h"

namespace vismap {

/// The built-in office: one storey of 40 x 25 x 2.6 m (1000 m^2), z up, with the centre of the
/// floor at the origin. A ring of corridors has offices on its outer side, and open-plan areas, a
/// meeting room and a kitchen on its inner side (see office_plan.h). It has 953 objects of 2100
/// shapes, with and without COCO classes, and is always the same.
Scene MakeOffice();

/// `count` camera poses T_W_C of one walk of 126 m around the whole corridor, at a height of 1.5 m,
/// looking ahead and a little down. It enters eight rooms through their doors. The path is closed
/// and begins at a corner, so its end sees little of the surface that its beginning has seen, and
/// about the same amount of surface. The steps have equal size in a measure that combines
/// translation and rotation.
std::vector<Pose> MakeOfficeWalk(int count);

}  // namespace vismap
