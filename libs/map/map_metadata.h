#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/pose.h"

namespace vismap {

/// The camera pose of one integrated frame.
struct CameraPose {
  int64_t utime = 0;  ///< [us]
  CameraId camera_id{0};
  Pose T_W_C = Pose::Identity();
};

/// What a map file holds beside the map.
struct MapMetadata {
  std::string map_id;
  std::string config;      ///< protobuf text of the config that the map was made with
  std::string created_by;  ///< program and version
  std::map<ClassId, std::string> class_names;
  std::vector<CameraPose> trajectory;  ///< in the order of integration
};

}  // namespace vismap
