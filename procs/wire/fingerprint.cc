#include "wire/fingerprint.h"

#include <array>
#include <span>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_delta_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/mesh_delta_t.hpp>
#include <vismap/object_list_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/process_status_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "base/digest.h"

namespace vismap {

int64_t TypesFingerprint() {
  const std::array<int64_t, 11> hashes = {
      rgbd_frame_t::getHash(),   detections_t::getHash(),    segmented_frame_t::getHash(),
      frame_commit_t::getHash(), map_delta_t::getHash(),     mesh_delta_t::getHash(),
      object_list_t::getHash(),  octree_t::getHash(),        map_request_t::getHash(),
      map_reply_t::getHash(),    process_status_t::getHash()};
  return static_cast<int64_t>(
      Checksum64({reinterpret_cast<const uint8_t*>(hashes.data()), sizeof(hashes)}));
}

}  // namespace vismap
