#pragma once

#include <Eigen/Core>
#include <string>

#include "base/class_names.h"
#include "base/result.h"
#include "freespace/occupancy.h"
#include "map/map_metadata.h"
#include "map/semantic_map.h"

namespace vismap {

/// Why the map shows what it shows at a point of W [m], as a JSON object on one line:
/// {"map_id":..,"revision":..,"at":[3],"voxel":[3],"center":[3],"state":"occupied","why":SENTENCE,
/// "block":"surface","distance_m":..,"weight":..,"observations":..,"thin_hits":..,"color":[3],
/// "labels":[{"label":..,"shown_as":..,"votes":..,"instance":..,"class":..,"class_name":..}],
/// "shown":{"segment":..,"instance":..,"class":..,"class_name":..},"last_frame":{..}}
///
/// `state` is free, occupied or unknown; `block` is surface, partly_free, all_free or unseen.
/// distance_m (signed, positive before the surface), weight and color are null where no depth was
/// integrated: outside of blocks near a surface, and in their voxels that no frame has seen. In
/// blocks far from surfaces, observations are counted to two only. A label that was merged is
/// `shown_as` its survivor. `shown` is what the vertices near this voxel have. `last_frame` is the
/// last one that changed the voxels of the block: revision, camera_id, utime [us]; null when that
/// is not known. Fails on a point that is not finite or farther than 100 km away.
Result<std::string> ExplainCell(const SemanticMap& map, const MapMetadata& metadata,
                                const OccupancyOptions& options, const Eigen::Vector3d& p_W,
                                const ClassNamer& class_name);

}  // namespace vismap
