#pragma once

#include <span>
#include <string>

#include "base/class_names.h"
#include "objects/objects.h"

namespace vismap {

/// The text of objects.json:
/// {"map_id":..,"objects":[{"instance":..,"class":..,"class_name":..,"score":..,"segments":[..],
/// "points":..,"center":[3],"size":[3],"orientation":[4],"frames":..}],"discovered":[..],
/// "structure":[..],"removed":[..]}
/// Lengths in metres in W; orientation = quaternion x, y, z, w of the box. Objects also carry
/// class_probabilities, area, first_utime, last_utime; discovered segments also `structure`, and
/// instance 0 and class 0; structure is of segments, too, with `kind`: see StructureKind; those
/// removed, named or discovered, have `removed_utime` and no box. All have `state`, "present" or
/// "removed". Numbers are rounded to 1e-6, keys stand in this order, one object per line.
std::string ObjectsJson(const std::string& map_id, std::span<const ObjectSummary> objects,
                        const ClassNamer& class_name);

}  // namespace vismap
