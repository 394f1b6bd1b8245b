#pragma once

#include "simulation/office_plan.h"
#include "simulation/office_stock.h"

namespace vismap {

/// Furnishes a room; two metres behind its door stay free.
void FurnishRoom(const OfficeRoom& room, OfficeStock* stock);

/// Things along a wall of the corridor, away from its openings. The corridor is on the side of the
/// wall that `toward` points to: 1 = greater coordinates, -1 = smaller.
void FurnishCorridor(const OfficeWall& wall, double toward, double from, double to,
                     OfficeStock* stock);

}  // namespace vismap
