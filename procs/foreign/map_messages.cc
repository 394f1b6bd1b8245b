#include "foreign/map_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <unordered_set>

#include "objects/object_mesh.h"
#include "render/palette.h"

namespace vismap {
namespace {

constexpr int kPointBytes = 16;
constexpr uint8_t kRosFloat32 = 7;
constexpr int8_t kDrakeFloat32 = 7, kDrakeUint32 = 6;
constexpr int64_t kDrakeFinite = 2;  // flags of lcmt_point_cloud
constexpr int8_t kDrakeMesh = 4;     // type of lcmt_viewer_geometry_data

foreign::std_msgs::Header HeaderOf(const std::string& frame, int64_t utime) {
  foreign::std_msgs::Header header{};
  header.stamp.sec = static_cast<int32_t>(utime / 1'000'000);
  header.stamp.nsec = static_cast<int32_t>(utime % 1'000'000 * 1000);
  header.frame_id = frame;
  return header;
}

template <typename Vector, typename Target>
void SetXyz(const Vector& from, Target* to) {
  to->x = from.x();
  to->y = from.y();
  to->z = from.z();
}

// x, y, z and four bytes of colour per point.
template <typename ColorOf>
std::vector<uint8_t> PackPoints(std::span<const SurfacePoint> points, const ColorOf& color_of) {
  std::vector<uint8_t> bytes(points.size() * kPointBytes);
  uint8_t* at = bytes.data();
  for (const SurfacePoint& point : points) {
    const std::array<float, 3> xyz = {point.p_W.x(), point.p_W.y(), point.p_W.z()};
    const uint32_t color = color_of(point.color);
    std::memcpy(at, xyz.data(), 12);
    std::memcpy(at + 12, &color, 4);
    at += kPointBytes;
  }
  return bytes;
}

// The cube of an edge of `spacing` that a point lies in.
uint64_t CubeOf(const Eigen::Vector3f& point, double spacing) {
  const Eigen::Array3d scaled = point.cast<double>().array() / spacing;
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<int64_t>(std::floor(scaled[axis]));
    key = (key << 21) | (static_cast<uint64_t>(cell) & ((uint64_t{1} << 21) - 1));
  }
  return key;
}

std::string NameOf(const ObjectSummary& object, const ClassNamer& class_name) {
  return ObjectFileName(object, object.discovered() ? "" : class_name(object.class_id));
}

std::array<float, 4> ColorOf(const ObjectSummary& object, float alpha) {
  const Rgb8 color = object.discovered() ? PaleColor(Raw(object.segments.front()))
                                         : StrongColor(Raw(object.instance));
  return {color.r / 255.0F, color.g / 255.0F, color.b / 255.0F, alpha};
}

std::vector<const ObjectSummary*> Present(std::span<const ObjectSummary> objects) {
  std::vector<const ObjectSummary*> present;
  for (const ObjectSummary& object : objects) {
    if (!object.removed() && !object.is_structure() && !object.segments.empty())
      present.push_back(&object);
  }
  return present;
}

Mesh BoxMesh(const OrientedBox& box) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner_B = 0.5 * box.size.cwiseProduct(Eigen::Vector3d(
                                               i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    MeshVertex vertex;
    vertex.position_W = (box.center_W + box.R_W_B * corner_B).cast<float>();
    mesh.vertices.push_back(vertex);
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

foreign::drake::lcmt_viewer_geometry_data ToGeometry(const Mesh& mesh, const std::string& name,
                                                     const std::array<float, 4>& color) {
  foreign::drake::lcmt_viewer_geometry_data geometry{};
  geometry.type = kDrakeMesh;
  geometry.quaternion[0] = 1;
  std::copy(color.begin(), color.end(), geometry.color);
  geometry.string_data = name;
  std::vector<float>& data = geometry.float_data;
  data = {static_cast<float>(mesh.vertices.size()), static_cast<float>(mesh.triangles.size())};
  for (const MeshVertex& vertex : mesh.vertices)
    data.insert(data.end(), vertex.position_W.data(), vertex.position_W.data() + 3);
  for (const auto& triangle : mesh.triangles)
    data.insert(data.end(), triangle.begin(), triangle.end());
  geometry.num_float_data = static_cast<int32_t>(data.size());
  return geometry;
}

// The columns of space that a costmap shows, and what is known of each.
struct Columns {
  int min_x = 0, min_y = 0, width = 0, height = 0;
  std::vector<CellState> states;
};

int FloorDiv(double value, double step) { return static_cast<int>(std::floor(value / step)); }

// Marks the columns of one block.
void AddBlock(BlockIndex index, const BlockOccupancy& block, double cell,
              const CostmapOptions& options, Columns* columns) {
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    const CellState state = block.At(offset);
    if (state == CellState::kUnknown) continue;
    const VoxelIndex voxel = VoxelAt(index, offset);
    const double z = (voxel.z + 0.5) * cell;
    if (z < options.min_z || z > options.max_z) continue;
    const int x = FloorDiv((voxel.x + 0.5) * cell, options.resolution) - columns->min_x;
    const int y = FloorDiv((voxel.y + 0.5) * cell, options.resolution) - columns->min_y;
    CellState& column =
        columns->states[static_cast<size_t>(y) * static_cast<size_t>(columns->width) +
                        static_cast<size_t>(x)];
    column = std::max(column, state);
  }
}

Result<Columns> ColumnsOf(const OccupancyMap& space, const CostmapOptions& options) {
  constexpr int64_t kMostCells = int64_t{1} << 24;
  Columns columns;
  const std::optional<OccupancyBox> known = space.KnownCells();
  if (!known) return columns;
  const double cell = space.cell_size();
  columns.min_x = FloorDiv((known->min.x + 0.5) * cell, options.resolution);
  columns.min_y = FloorDiv((known->min.y + 0.5) * cell, options.resolution);
  const int64_t width =
      int64_t{FloorDiv((known->max.x - 0.5) * cell, options.resolution)} - columns.min_x + 1;
  const int64_t height =
      int64_t{FloorDiv((known->max.y - 0.5) * cell, options.resolution)} - columns.min_y + 1;
  if (width * height > kMostCells) {
    return Fail("the costmap would have " + std::to_string(width) + "x" + std::to_string(height) +
                " cells; choose a larger adapter.costmap_resolution_m");
  }
  columns.width = static_cast<int>(width);
  columns.height = static_cast<int>(height);
  columns.states.assign(static_cast<size_t>(width * height), CellState::kUnknown);
  for (const BlockIndex index : space.SortedIndices())
    AddBlock(index, space.At(index), cell, options, &columns);
  return columns;
}

}  // namespace

std::vector<SurfacePoint> ThinOut(const Mesh& mesh, double spacing) {
  std::vector<SurfacePoint> points;
  std::unordered_set<uint64_t> taken;
  for (const MeshVertex& vertex : mesh.vertices) {
    if (taken.insert(CubeOf(vertex.position_W, spacing)).second)
      points.push_back({vertex.position_W, vertex.color});
  }
  return points;
}

Mesh Coarsened(const Mesh& mesh, double spacing) {
  Mesh coarse;
  std::unordered_map<uint64_t, uint32_t> first;  // vertex of each cube
  std::vector<uint32_t> joined;
  for (const MeshVertex& vertex : mesh.vertices) {
    const auto next = static_cast<uint32_t>(coarse.vertices.size());
    const auto [at, is_new] = first.emplace(CubeOf(vertex.position_W, spacing), next);
    if (is_new) coarse.vertices.push_back(vertex);
    joined.push_back(at->second);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    if (joined[a] != joined[b] && joined[b] != joined[c] && joined[c] != joined[a])
      coarse.triangles.push_back({joined[a], joined[b], joined[c]});
  }
  return coarse;
}

foreign::sensor_msgs::PointCloud2 ToPointCloud2(std::span<const SurfacePoint> points,
                                                const std::string& frame, int64_t utime) {
  foreign::sensor_msgs::PointCloud2 cloud{};
  cloud.header = HeaderOf(frame, utime);
  cloud.height = 1;
  cloud.width = static_cast<int32_t>(points.size());
  for (const char* name : {"x", "y", "z", "rgb"}) {
    foreign::sensor_msgs::PointField field{};
    field.name = name;
    field.offset = 4 * static_cast<int32_t>(cloud.fields.size());
    field.datatype = kRosFloat32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.fields_length = static_cast<int32_t>(cloud.fields.size());
  cloud.point_step = kPointBytes;
  cloud.row_step = kPointBytes * cloud.width;
  cloud.data = PackPoints(points, [](const Rgb8& color) {
    return uint32_t{color.r} << 16 | uint32_t{color.g} << 8 | uint32_t{color.b};
  });
  cloud.data_length = static_cast<int32_t>(cloud.data.size());
  cloud.is_dense = 1;
  return cloud;
}

foreign::drake::lcmt_point_cloud ToDrakeCloud(std::span<const SurfacePoint> points,
                                              const std::string& frame, int64_t utime) {
  foreign::drake::lcmt_point_cloud cloud{};
  cloud.utime = utime;
  cloud.frame_name = frame;
  cloud.width = static_cast<int64_t>(points.size());
  cloud.height = 1;
  for (const char* name : {"x", "y", "z", "rgb"}) {
    foreign::drake::lcmt_point_cloud_field field{};
    field.name = name;
    field.byte_offset = 4 * static_cast<int32_t>(cloud.fields.size());
    field.datatype = cloud.fields.size() < 3 ? kDrakeFloat32 : kDrakeUint32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.num_fields = static_cast<int32_t>(cloud.fields.size());
  cloud.flags = kDrakeFinite;
  cloud.point_step = kPointBytes;
  cloud.row_step = kPointBytes * cloud.width;
  cloud.data = PackPoints(points, [](const Rgb8& color) {
    return uint32_t{color.r} | uint32_t{color.g} << 8 | uint32_t{color.b} << 16;
  });
  cloud.data_size = static_cast<int64_t>(cloud.data.size());
  return cloud;
}

Result<foreign::nav_msgs::OccupancyGrid> ToCostmap(const OccupancyMap& space,
                                                   const CostmapOptions& options,
                                                   const std::string& frame, int64_t utime) {
  const Result<Columns> columns = ColumnsOf(space, options);
  if (!columns) return tl::unexpected(columns.error());
  foreign::nav_msgs::OccupancyGrid grid{};
  grid.header = HeaderOf(frame, utime);
  grid.info.map_load_time = grid.header.stamp;
  grid.info.resolution = static_cast<float>(options.resolution);
  grid.info.width = columns->width;
  grid.info.height = columns->height;
  grid.info.origin.position.x = columns->min_x * options.resolution;
  grid.info.origin.position.y = columns->min_y * options.resolution;
  grid.info.origin.orientation.w = 1;
  for (const CellState state : columns->states) {
    grid.data.push_back(state == CellState::kOccupied ? int8_t{100}
                        : state == CellState::kFree   ? int8_t{0}
                                                      : static_cast<int8_t>(options.unknown));
  }
  grid.data_length = static_cast<int32_t>(grid.data.size());
  return grid;
}

foreign::vision_msgs::Detection3DArray ToDetections(std::span<const ObjectSummary> objects,
                                                    const ClassNamer& class_name,
                                                    const std::string& frame, int64_t utime) {
  foreign::vision_msgs::Detection3DArray array{};
  array.header = HeaderOf(frame, utime);
  for (const ObjectSummary* object : Present(objects)) {
    foreign::vision_msgs::Detection3D detection{};
    detection.header = array.header;
    detection.id = NameOf(*object, class_name);
    SetXyz(object->box.center_W, &detection.bbox.center.position);
    SetXyz(object->box.R_W_B, &detection.bbox.center.orientation);
    detection.bbox.center.orientation.w = object->box.R_W_B.w();
    SetXyz(object->box.size, &detection.bbox.size);
    foreign::vision_msgs::ObjectHypothesisWithPose result{};
    result.hypothesis.class_id = object->discovered() ? "" : class_name(object->class_id);
    result.hypothesis.score = object->score;
    result.pose.pose = detection.bbox.center;
    detection.results = {result};
    detection.results_length = 1;
    array.detections.push_back(std::move(detection));
  }
  array.detections_length = static_cast<int32_t>(array.detections.size());
  return array;
}

foreign::drake::lcmt_viewer_link_data ToDeformable(std::span<const ObjectSummary> objects,
                                                   std::span<const Mesh> meshes,
                                                   const ClassNamer& class_name) {
  foreign::drake::lcmt_viewer_link_data link{};
  link.name = "vismap";
  for (size_t i = 0; i < objects.size() && i < meshes.size(); ++i) {
    if (Present(objects.subspan(i, 1)).empty()) continue;
    const std::string name = NameOf(objects[i], class_name);
    if (!meshes[i].triangles.empty())
      link.geom.push_back(ToGeometry(meshes[i], "surface/" + name, ColorOf(objects[i], 1)));
    link.geom.push_back(
        ToGeometry(BoxMesh(objects[i].box), "box/" + name, ColorOf(objects[i], 0.3F)));
  }
  link.num_geom = static_cast<int32_t>(link.geom.size());
  return link;
}

foreign::robotlocomotion::viewer2_comms_t ToTreeviewer(std::span<const SurfacePoint> points,
                                                       std::span<const ObjectSummary> objects,
                                                       const ClassNamer& class_name, int64_t utime,
                                                       std::set<std::string>* shown) {
  using nlohmann::json;
  json cloud = {{"type", "pointcloud"}, {"points", json::array()}, {"color", {1, 1, 1, 1}}};
  json rgb = json::array();
  for (const SurfacePoint& point : points) {
    cloud["points"].push_back({point.p_W.x(), point.p_W.y(), point.p_W.z()});
    rgb.push_back({point.color.r / 255.0, point.color.g / 255.0, point.color.b / 255.0});
  }
  cloud["channels"] = {{"rgb", rgb}};
  json data = {{"timestamp", utime},
               {"delete", json::array()},
               {"setgeometry", json::array()},
               {"settransform", json::array()}};
  data["setgeometry"].push_back({{"path", {"vismap", "surface"}}, {"geometry", cloud}});
  std::set<std::string> names;
  for (const ObjectSummary* object : Present(objects)) {
    const std::string name = NameOf(*object, class_name);
    names.insert(name);
    const json path = {"vismap", "objects", name};
    const OrientedBox& box = object->box;
    data["setgeometry"].push_back({{"path", path},
                                   {"geometry",
                                    {{"type", "box"},
                                     {"lengths", {box.size.x(), box.size.y(), box.size.z()}},
                                     {"color", ColorOf(*object, 0.4F)}}}});
    data["settransform"].push_back(
        {{"path", path},
         {"transform",
          {{"translation", {box.center_W.x(), box.center_W.y(), box.center_W.z()}},
           {"quaternion", {box.R_W_B.w(), box.R_W_B.x(), box.R_W_B.y(), box.R_W_B.z()}}}}});
  }
  for (const std::string& name : *shown) {
    if (!names.contains(name)) data["delete"].push_back({{"path", {"vismap", "objects", name}}});
  }
  *shown = std::move(names);
  const std::string text = data.dump(-1, ' ', false, json::error_handler_t::replace);
  foreign::robotlocomotion::viewer2_comms_t message{};
  message.utime = utime;
  message.format = "treeviewer_json";
  message.format_version_major = 1;
  message.format_version_minor = 0;
  message.data.assign(text.begin(), text.end());
  message.num_bytes = static_cast<int32_t>(message.data.size());
  return message;
}

}  // namespace vismap
