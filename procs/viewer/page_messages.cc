#include "viewer/page_messages.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/class_names.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little);
using PageJson = nlohmann::ordered_json;

constexpr uint8_t kBlockKind = 1, kPictureKind = 2, kBatchKind = 3;
constexpr uint16_t kWideIndices = 1;    // flag
constexpr int32_t kMostNarrow = 65535;  // vertices whose indices fit into 16 bits
constexpr int kClasses = 91;            // of COCO

template <typename Number>
void Put(Number value, std::vector<uint8_t>* bytes) {
  const size_t at = bytes->size();
  bytes->resize(at + sizeof value);
  std::memcpy(bytes->data() + at, &value, sizeof value);
}

void PadTo4(std::vector<uint8_t>* bytes) { bytes->resize((bytes->size() + 3) / 4 * 4); }

void PutHeader(const BlockIndex& index, float edge_m, bool wide, uint32_t vertices,
               uint32_t triangles, uint64_t hash, int64_t revision, std::vector<uint8_t>* bytes) {
  Put(kBlockKind, bytes);
  Put(uint8_t{0}, bytes);
  Put(wide ? kWideIndices : uint16_t{0}, bytes);
  for (const int32_t i : {index.x, index.y, index.z}) Put(i, bytes);
  Put(edge_m, bytes);
  Put(static_cast<uint32_t>(revision), bytes);
  Put(vertices, bytes);
  Put(triangles, bytes);
  Put(hash, bytes);
  bytes->resize(kPageBlockHeader);
}

template <typename Index>
void PutIndices(const mesh_block_t& block, std::vector<uint8_t>* bytes) {
  for (size_t i = 0; i < block.a.size(); ++i) {
    for (const int32_t corner : {block.a[i], block.b[i], block.c[i]})
      Put(static_cast<Index>(corner), bytes);
  }
}

void PutVertices(const mesh_block_t& block, std::vector<uint8_t>* bytes) {
  const auto count = static_cast<size_t>(block.n_vertices);
  for (size_t i = 0; i < count; ++i) {
    for (const int16_t step : {block.x[i], block.y[i], block.z[i], int16_t{0}}) Put(step, bytes);
  }
  for (size_t i = 0; i < count; ++i) {
    for (const int8_t step : {block.nx[i], block.ny[i], block.nz[i], int8_t{0}}) Put(step, bytes);
  }
  for (size_t i = 0; i < count; ++i) {
    for (const uint8_t level : {block.red[i], block.green[i], block.blue[i], block.seen[i]})
      Put(level, bytes);
  }
  for (const int32_t segment : block.segment) Put(segment, bytes);
  for (const int32_t instance : block.instance) Put(instance, bytes);
  for (const int16_t class_id : block.class_id) Put(class_id, bytes);
  PadTo4(bytes);
}

// Texts from the bus may have bytes that are not UTF-8, which are replaced.
std::string Text(const PageJson& json) {
  return json.dump(-1, ' ', false, PageJson::error_handler_t::replace);
}

std::string Hex16(uint64_t number) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

PageJson ObjectJson(const object_t& object) {
  PageJson json;
  json["instance"] = object.instance;
  json["class"] = object.class_id;
  json["class_name"] = object.class_name.empty() ? "unknown" : object.class_name;
  json["score"] = object.score;
  json["segments"] = object.segments;
  json["points"] = object.points;
  if (object.removed_utime == 0) {
    const double* q = object.orientation;
    json["center"] = {object.center_W[0], object.center_W[1], object.center_W[2]};
    json["size"] = {object.size_m[0], object.size_m[1], object.size_m[2]};
    json["orientation"] = {q[1], q[2], q[3], q[0]};
  }
  json["frames"] = object.frames;
  json["area"] = object.area_m2;
  json["first_utime"] = object.first_utime;
  json["last_utime"] = object.last_utime;
  json["state"] = object.removed_utime == 0 ? "present" : "removed";
  if (object.removed_utime != 0) json["removed_utime"] = object.removed_utime;
  json["class_probabilities"] = PageJson::object();
  for (size_t i = 0; i < object.class_ids.size(); ++i)
    json["class_probabilities"][std::to_string(object.class_ids[i])] =
        object.class_probabilities[i];
  json["discovered"] = static_cast<bool>(object.discovered);
  json["removed"] = object.removed_utime != 0;
  json["structure"] = false;
  return json;
}

PageJson CameraJson(const CameraView& view) {
  const FrameHeader& header = view.header;
  PageJson json;
  json["camera_id"] = Raw(header.camera_id);
  json["utime"] = header.utime;
  json["T_W_C"] = PageJson::array();
  const Eigen::Matrix4d T_W_C = header.T_W_C.matrix();
  for (Eigen::Index row = 0; row < 4; ++row) {
    for (Eigen::Index column = 0; column < 4; ++column) json["T_W_C"].push_back(T_W_C(row, column));
  }
  json["width"] = header.camera.width;
  json["height"] = header.camera.height;
  json["fx"] = header.camera.fx;
  json["fy"] = header.camera.fy;
  json["cx"] = header.camera.cx;
  json["cy"] = header.camera.cy;
  json["picture"] = view.picture;
  json["had_detections"] = view.had_detections;
  json["n_detections"] = view.detections;
  if (view.positions >= 0) json["positions"] = view.positions;
  return json;
}

}  // namespace

std::vector<uint8_t> EncodePageBlock(const mesh_block_t& block, uint64_t hash, int64_t revision) {
  const bool wide = block.n_vertices > kMostNarrow;
  std::vector<uint8_t> bytes;
  bytes.reserve(kPageBlockHeader + 26 * static_cast<size_t>(block.n_vertices) + 4 +
                (wide ? 12 : 6) * static_cast<size_t>(block.n_triangles) + 4);
  PutHeader({block.index[0], block.index[1], block.index[2]}, block.edge_m, wide,
            static_cast<uint32_t>(block.n_vertices), static_cast<uint32_t>(block.n_triangles), hash,
            revision, &bytes);
  PutVertices(block, &bytes);
  if (wide) {
    PutIndices<uint32_t>(block, &bytes);
  } else {
    PutIndices<uint16_t>(block, &bytes);
  }
  PadTo4(&bytes);
  return bytes;
}

std::vector<uint8_t> EncodeDeletedBlock(BlockIndex index, double edge_m, int64_t revision) {
  std::vector<uint8_t> bytes;
  PutHeader(index, static_cast<float>(edge_m), false, 0, 0, 0, revision, &bytes);
  return bytes;
}

std::vector<uint8_t> EncodeBlockBatch(std::span<const FrameBytes> blocks) {
  std::vector<uint8_t> bytes;
  size_t size = 8;
  for (const FrameBytes& block : blocks) size += 4 + block->size();
  bytes.reserve(size);
  Put(kBatchKind, &bytes);
  Put(uint8_t{0}, &bytes);
  Put(uint16_t{0}, &bytes);
  Put(static_cast<uint32_t>(blocks.size()), &bytes);
  for (const FrameBytes& block : blocks) {
    Put(static_cast<uint32_t>(block->size()), &bytes);
    bytes.insert(bytes.end(), block->begin(), block->end());
  }
  return bytes;
}

std::string HelloText(const std::string& version, const std::string& source,
                      const std::string& mode) {
  PageJson json{{"kind", "hello"}, {"protocol", 1},    {"version", version},
                {"mode", mode},    {"control", false}, {"source", source}};
  for (int id = 1; id < kClasses; ++id) {
    const ClassId class_id{static_cast<uint16_t>(id)};
    json["class_names"][std::to_string(id)] = ClassName(class_id);
  }
  return Text(json);
}

std::string MapText(const MapSummary& map, size_t waiting, bool reset) {
  PageJson json{{"kind", "map"},
                {"map_id", map.map_id},
                {"revision", map.revision},
                {"utime", map.utime},
                {"frames", std::max<int64_t>(map.revision, 0)},
                {"blocks", map.blocks},
                {"triangles", map.triangles},
                {"digest", Hex16(map.digest)},
                {"mesh_digest", map.mesh_digest},
                {"voxel_size_m", map.voxel_size_m},
                {"block_edge_m", map.block_edge_m},
                {"age_s", map.age_s},
                {"in_sync", map.in_sync},
                {"server_start_utime", map.server_start_utime},
                {"bytes", map.bytes},
                {"waiting", waiting}};
  if (reset) json["reset"] = true;
  return Text(json);
}

std::string ObjectsText(const object_list_t& objects) {
  PageJson json{{"kind", "objects"},
                {"map_id", objects.map_id},
                {"revision", objects.revision},
                {"utime", objects.utime},
                {"objects", PageJson::array()}};
  for (const object_t& object : objects.objects) json["objects"].push_back(ObjectJson(object));
  return Text(json);
}

std::string NavigationText(const navigation_status_t& navigation) {
  PageJson json{{"kind", "navigation"},
                {"utime", navigation.utime},
                {"published_utime", navigation.published_utime},
                {"map_id", navigation.map_id},
                {"revision", navigation.revision},
                {"in_sync", static_cast<bool>(navigation.in_sync)},
                {"server_utime", navigation.server_utime},
                {"message", navigation.message},
                {"n_assumed_free", navigation.n_assumed_free},
                {"channels", navigation.channels},
                {"revisions", navigation.revisions},
                {"utimes", navigation.utimes},
                {"published_utimes", navigation.published_utimes}};
  return Text(json);
}

std::string NoticeText(const std::string& level, const std::string& sentence) {
  return Text({{"kind", "notice"}, {"level", level}, {"text", sentence}});
}

std::string TrajectoryText(int camera_id, size_t from,
                           std::span<const std::array<float, 3>> path_W) {
  PageJson json{{"kind", "trajectory"},
                {"camera_id", camera_id},
                {"from", from},
                {"positions", PageJson::array()}};
  for (const std::array<float, 3>& p_W : path_W) json["positions"].push_back(p_W);
  return Text(json);
}

std::string CamerasText(std::span<const CameraView> cameras) {
  PageJson json{{"kind", "cameras"}, {"cameras", PageJson::array()}};
  for (const CameraView& view : cameras) json["cameras"].push_back(CameraJson(view));
  return Text(json);
}

std::vector<uint8_t> EncodePicture(int camera_id, std::string json, std::span<const uint8_t> jpeg) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<uint8_t> bytes;
  bytes.reserve(8 + json.size() + jpeg.size());
  Put(kPictureKind, &bytes);
  Put(static_cast<uint8_t>(camera_id), &bytes);
  Put(uint16_t{0}, &bytes);
  Put(static_cast<uint32_t>(json.size()), &bytes);
  bytes.insert(bytes.end(), json.begin(), json.end());
  bytes.insert(bytes.end(), jpeg.begin(), jpeg.end());
  return bytes;
}

std::string ErrorText(const std::string& sentence) { return Text({{"error", sentence}}); }

std::vector<uint8_t> JsonHeader(std::string json) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<uint8_t> bytes;
  Put(static_cast<uint32_t>(json.size()), &bytes);
  bytes.insert(bytes.end(), json.begin(), json.end());
  return bytes;
}

}  // namespace vismap
