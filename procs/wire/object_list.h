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

/// The content of one OBJECTS message: all objects of a map.
struct ObjectList {
  int64_t utime = 0;  ///< of the newest frame contained [us]
  std::string map_id;
  int64_t revision = 0;
  /// Instances by ascending id, then discovered segments, then removed objects.
  std::vector<ObjectSummary> objects;
};

/// Leaves out structure (floor, walls): the message lists movable things only.
object_list_t Encode(const ObjectList& list, const ClassNamer& class_name);

/// Fails, naming the object, on ids and scores out of range and on boxes that are not finite.
Result<ObjectList> Decode(const object_list_t& message);

}  // namespace vismap
