#pragma once

#include "objects/label_surfaces.h"

namespace vismap {

/// Finds the upward direction: the one of the options, unless it is a guess. A guess from the
/// cameras is replaced when the map's own levels outvote how the cameras were held: when much more
/// surface stands on large planes that face another direction, about which the cameras were rolled
/// by a quarter turn or upside down. Then it is corrected by RefineUp. `surfaces` must have the
/// points of all labels with at least kLeastPieceArea; those of others are not needed.
UpDirection FindUp(const ObjectOptions& options, const LabelSurfaces& surfaces);

/// Smaller pieces of surface do not vote [m^2].
inline constexpr double kLeastPieceArea = 0.05;

/// Whether the cameras may have been rolled, so that FindUp needs the points of small pieces, too.
bool MayBeRolled(const CameraUp& cameras);

}  // namespace vismap
