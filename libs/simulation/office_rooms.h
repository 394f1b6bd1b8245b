#pragma once

#include "simulation/office_plan.h"
#include "simulation/office_stock.h"

namespace vismap {

/// Furnishes a room. The two metres behind its door stay free.
void FurnishRoom(const OfficeRoom& room, OfficeStock* stock);

/// Puts objects along a wall of the corridor between `from` and `to` [m], away from the wall's
/// openings. The corridor is on the side of larger coordinates if `toward` is 1, of smaller ones if
/// it is -1.
void FurnishCorridor(const OfficeWall& wall, double toward, double from, double to,
                     OfficeStock* stock);

}  // namespace vismap
