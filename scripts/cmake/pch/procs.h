// Precompiled for procs/: what libs/ has, and the messages of the bus.
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/pose_correction_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "libs.h"
