#pragma once

#include <span>
#include <string>

#include "base/class_names.h"
#include "objects/objects.h"

namespace vismap {

/// The text of objects.json:
/// {"map_id":..,"up":{"direction":[3],"reason":..},"objects":[{"instance":..,"class":..,"class_name":..,"score":..,"segments":[..],
/// "points":..,"center":[3],"size":[3],"orientation":[4],"frames":..}],"discovered":[..],
/// "structure":[..],"removed":[..]}
/// `up` is the upward direction in W that was found, and why. Center, size and orientation
/// (quaternion x, y, z, w: R_W_B) are of the box; lengths in metres, in W. All entries also have
/// area [m^2], first_utime, last_utime [us] and state, "present" or "removed". Instances have
/// class_probabilities. Discovered segments have instance 0, class 0 and the flag `structure`;
/// structure has its `kind` (see NameOf(StructureKind)). Removed objects have removed_utime [us]
/// and no box. Numbers are rounded to 1e-6. One object per line.
std::string ObjectsJson(const std::string& map_id, const UpDirection& up,
                        std::span<const ObjectSummary> objects, const ClassNamer& class_name);

}  // namespace vismap
