#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/pose.h"

namespace vismap {

/// One camera pose that went into a map.
struct CameraPose {
  int64_t utime = 0;  ///< [us]
  CameraId camera_id{0};
  Pose T_W_C = Pose::Identity();
};

/// What is saved beside the map itself.
struct MapMetadata {
  std::string map_id;
  std::string config;      ///< protobuf text that the map was made with
  std::string created_by;  ///< program and version
  std::map<ClassId, std::string> class_names;
  std::vector<CameraPose> trajectory;  ///< in the order of integration
};

}  // namespace vismap
