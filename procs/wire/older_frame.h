#pragma once

#include <vismap/rgbd_frame_t.hpp>
#include <vismap/rgbd_frame_v1_t.hpp>

namespace vismap {

/// The frame in the current version of its type: depth is registered, and the camera is copied to
/// colour and depth. Its checksum is not computed.
rgbd_frame_t ToCurrentVersion(const rgbd_frame_v1_t& older);

}  // namespace vismap
