#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <vismap/object_list_t.hpp>

#include "base/result.h"
#include "exports/objects_json.h"
#include "objects/objects.h"

namespace vismap {

/// All objects of a map, as OBJECTS carries them.
struct ObjectList {
  int64_t utime = 0;  ///< of the newest frame contained [us]
  std::string map_id;
  int64_t revision = 0;
  std::vector<ObjectSummary> objects;  ///< instances ascending, then discovered, then removed ones
};

/// Structure (floor, walls) is left out: the message lists things.
object_list_t Encode(const ObjectList& list, const ClassNamer& class_name);

/// Fails, naming the object, on ids and scores out of range and boxes that are not finite.
/// Structure does not travel.
Result<ObjectList> Decode(const object_list_t& message);

}  // namespace vismap
