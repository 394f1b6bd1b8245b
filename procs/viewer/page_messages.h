#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <vismap/mesh_block_t.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/object_list_t.hpp>

#include "geometry/frame.h"
#include "map/block.h"

namespace vismap {

// What the page gets over its WebSocket: text frames with JSON that has a `kind`, and binary frames
// whose first byte is their kind. procs/README.md, vismap-viewer, lists them. All numbers are
// little-endian.

using FrameBytes = std::shared_ptr<const std::vector<uint8_t>>;

/// The surface of a block, kind 1: a header of 48 bytes, then positions u16[4n], normals i8[4n],
/// colours u8[4n], segments u32[n], instances u32[n], classes u16[n] padded to 4 bytes, and indices
/// u16[3m], or u32[3m] with more than 65535 vertices. `block` must have passed Check(mesh_delta_t).
std::vector<uint8_t> EncodePageBlock(const mesh_block_t& block, uint64_t hash, int64_t revision);
/// The same for a block that no longer has a surface.
std::vector<uint8_t> EncodeDeletedBlock(BlockIndex index, double edge_m, int64_t revision);
inline constexpr size_t kPageBlockHeader = 48;  // [bytes]
/// Several blocks in one message, kind 3: u8 kind, u8 0, u16 0, u32 number of blocks; then for each
/// block u32 size and its bytes, which are a multiple of 4.
std::vector<uint8_t> EncodeBlockBatch(std::span<const FrameBytes> blocks);

/// The map as a whole, see MapText.
struct MapSummary {
  std::string map_id;
  int64_t revision = -1;  ///< -1 = no map yet
  int64_t utime = 0;      ///< of the newest frame in it [us]
  size_t blocks = 0, triangles = 0;
  uint64_t digest = 0;  ///< sum of the hashes of all blocks, modulo 2^64
  std::string mesh_digest;
  double voxel_size_m = 0, block_edge_m = 0;  ///< 0 = not known yet
  double age_s = 0;                           ///< since the map server was heard last
  bool in_sync = false;
  std::map<std::string, int64_t> bytes;  ///< memory of the map by layer; empty = not known
  int64_t server_start_utime = 0;        ///< when the map server was started [us]; 0 = not known
};

/// `mode`: "live" or "log".
std::string HelloText(const std::string& version, const std::string& source,
                      const std::string& mode = "live");
/// `waiting`: blocks that this page does not have yet. `reset`: it must forget all blocks.
std::string MapText(const MapSummary& map, size_t waiting, bool reset);
std::string ObjectsText(const object_list_t& objects);
std::string NavigationText(const navigation_status_t& navigation);
std::string NoticeText(const std::string& level, const std::string& sentence);
/// Positions of a camera [m], the first of them being number `from`.
std::string TrajectoryText(int camera_id, size_t from,
                           std::span<const std::array<float, 3>> path_W);

/// A camera as it was at its newest frame.
struct CameraView {
  FrameHeader header;
  int64_t picture = 0;  ///< number of its newest picture; 0 = none
  bool had_detections = false;
  size_t detections = 0;
  int64_t positions = -1;  ///< of its path that belong to what is shown; -1 = all
};
std::string CamerasText(std::span<const CameraView> cameras);

/// A picture of a camera, kind 2: u8 kind, u8 camera, u16 0, u32 size of the JSON, the JSON padded
/// with spaces to a multiple of 4 bytes, then the bytes of a JPEG.
std::vector<uint8_t> EncodePicture(int camera_id, std::string json, std::span<const uint8_t> jpeg);

/// {"error": sentence}
std::string ErrorText(const std::string& sentence);
/// The header of a binary answer: u32 size of the JSON, the JSON padded with spaces to 4 bytes.
std::vector<uint8_t> JsonHeader(std::string json);

}  // namespace vismap
