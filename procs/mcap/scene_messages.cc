#include "mcap/scene_messages.h"

#include <algorithm>
#include <cmath>

#include "base/printable.h"
#include "foxglove.pb.h"
#include "mcap/foxglove_fields.h"

namespace vismap {
namespace {

using Field = foxglove::PackedElementField;

Rgb8 ColorOf(CellState state) {
  if (state == CellState::kOccupied) return kOccupiedColor;
  return state == CellState::kFree ? kFreeColor : kNotSeenColor;
}

uint8_t AlphaOf(CellState state) {
  if (state == CellState::kOccupied) return 255;
  return state == CellState::kFree ? 60 : 20;
}

// Adds fields to a cloud or a grid, each behind the one before.
template <typename Message>
class FieldList {
 public:
  explicit FieldList(Message* message) : message_(*message) {}
  void Add(const std::string& name, Field::NumericType type, uint32_t bytes) {
    Field* field = message_.add_fields();
    field->set_name(name);
    field->set_type(type);
    field->set_offset(offset_);
    offset_ += bytes;
  }
  void AddColor() {
    for (const char* channel : {"red", "green", "blue", "alpha"}) Add(channel, Field::UINT8, 1);
  }
  void AddPosition() {
    for (const char* axis : {"x", "y", "z"}) Add(axis, Field::FLOAT32, 4);
  }
  uint32_t stride() const { return offset_; }

 private:
  Message& message_;
  uint32_t offset_ = 0;
};

void AppendColor(Rgb8 color, uint8_t alpha, std::string* data) {
  for (const uint8_t channel : {color.r, color.g, color.b, alpha}) AppendNumber(channel, data);
}

void AppendPosition(const Eigen::Vector3f& position, std::string* data) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) AppendNumber(position[axis], data);
}

foxglove::PointCloud NewCloud(int64_t utime) {
  foxglove::PointCloud cloud;
  SetTime(utime, cloud.mutable_timestamp());
  cloud.set_frame_id(kWorldFrame);
  SetPose(Pose::Identity(), cloud.mutable_pose());
  return cloud;
}

std::string IdOf(const BlockIndex& index) {
  return std::to_string(index.x) + "/" + std::to_string(index.y) + "/" + std::to_string(index.z);
}

void AddTriangles(const Mesh& mesh, Coloring coloring, foxglove::SceneEntity* entity) {
  foxglove::TriangleListPrimitive* list = entity->add_triangles();
  SetPose(Pose::Identity(), list->mutable_pose());
  for (const MeshVertex& vertex : mesh.vertices) {
    SetVector(vertex.position_W.cast<double>(), list->add_points());
    SetColor(VertexColor(vertex, coloring), 1, list->add_colors());
  }
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t corner : triangle) list->add_indices(corner);
}

foxglove::SceneEntity* AddEntity(const std::string& id, int64_t log_us,
                                 foxglove::SceneUpdate* update) {
  foxglove::SceneEntity* entity = update->add_entities();
  SetTime(log_us, entity->mutable_timestamp());
  entity->set_frame_id(kWorldFrame);
  entity->set_id(id);
  entity->mutable_lifetime();
  return entity;
}

void DeleteAll(int64_t log_us, foxglove::SceneUpdate* update) {
  foxglove::SceneEntityDeletion* deletion = update->add_deletions();
  SetTime(log_us, deletion->mutable_timestamp());
  deletion->set_type(foxglove::SceneEntityDeletion::ALL);
}

uint32_t FirstSegmentOf(const ObjectSummary& object) {
  return object.segments.empty() ? 0 : Raw(object.segments.front());
}

std::string ObjectId(const ObjectSummary& object) {
  return object.discovered() ? "discovered " + std::to_string(FirstSegmentOf(object))
                             : "object " + std::to_string(Raw(object.instance));
}

std::string ObjectText(const ObjectSummary& object, const ClassNamer& class_name) {
  if (object.discovered()) return ObjectId(object);
  char score[16];
  std::snprintf(score, sizeof(score), " (%.2f)", object.score);
  return PrintableText(class_name(object.class_id)) + " " + std::to_string(Raw(object.instance)) +
         score;
}

void AddObjectMetadata(const ObjectSummary& object, const ClassNamer& class_name,
                       foxglove::SceneEntity* entity) {
  std::string segments;
  for (const SegmentLabel segment : object.segments)
    segments += (segments.empty() ? "" : " ") + std::to_string(Raw(segment));
  AddMetadata("instance", std::to_string(Raw(object.instance)), entity);
  AddMetadata("class_id", std::to_string(Raw(object.class_id)), entity);
  AddMetadata("class", PrintableText(class_name(object.class_id)), entity);
  AddMetadata("score", std::to_string(object.score), entity);
  AddMetadata("segments", segments, entity);
  AddMetadata("points", std::to_string(object.points), entity);
  AddMetadata("area_m2", std::to_string(object.area), entity);
  AddMetadata("frames", std::to_string(object.frames), entity);
  AddMetadata("first_utime", std::to_string(object.first_utime), entity);
  AddMetadata("last_utime", std::to_string(object.last_utime), entity);
}

void AddBox(const ObjectSummary& object, const ClassNamer& class_name,
            foxglove::SceneEntity* entity) {
  const Rgb8 color =
      object.discovered() ? PaleColor(FirstSegmentOf(object)) : StrongColor(Raw(object.instance));
  const OrientedBox& box = object.box;
  foxglove::CubePrimitive* cube = entity->add_cubes();
  SetPose(box.center_W, box.R_W_B, cube->mutable_pose());
  SetVector(box.size, cube->mutable_size());
  SetColor(color, 0.3, cube->mutable_color());
  foxglove::TextPrimitive* text = entity->add_texts();
  const Eigen::Vector3d top = box.R_W_B * Eigen::Vector3d(0, 0, box.size.z() / 2 + 0.05);
  SetPose(box.center_W + top, Eigen::Quaterniond::Identity(), text->mutable_pose());
  text->set_billboard(true);
  text->set_scale_invariant(true);
  text->set_font_size(14);
  SetColor(color, 1, text->mutable_color());
  text->set_text(ObjectText(object, class_name));
}

// Calls visit(centre [m]) for every cell of this state, by ascending block.
template <typename Visit>
void ForEachCell(const OccupancyMap& map, CellState state, const Visit& visit) {
  for (const BlockIndex index : map.SortedIndices()) {
    const BlockOccupancy& block = map.At(index);
    if (block.is_uniform() && !block.is(state)) continue;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      if (block.At(offset) != state) continue;
      const VoxelIndex cell = VoxelAt(index, offset);
      const Eigen::Array3d corner(cell.x, cell.y, cell.z);
      visit(((corner + 0.5) * map.cell_size()).matrix().cast<float>());
    }
  }
}

double MedianHeight(std::vector<float> heights) {
  std::erase_if(heights, [](float height) { return !std::isfinite(height); });
  if (heights.empty()) return 0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return static_cast<double>(*middle);
}

}  // namespace

FoxgloveMessage SurfaceMessage(std::span<const BlockMesh> changed, bool reset, Coloring coloring,
                               int64_t log_us) {
  foxglove::SceneUpdate update;
  if (reset) DeleteAll(log_us, &update);
  for (const BlockMesh& block : changed) {
    const std::string id = IdOf(block.block);
    if (!block.mesh.triangles.empty()) {
      AddTriangles(block.mesh, coloring, AddEntity(id, log_us, &update));
    } else if (!reset) {
      foxglove::SceneEntityDeletion* deletion = update.add_deletions();
      SetTime(log_us, deletion->mutable_timestamp());
      deletion->set_type(foxglove::SceneEntityDeletion::MATCHING_ID);
      deletion->set_id(id);
    }
  }
  return EncodeFoxglove(update);
}

FoxgloveMessage SurfaceCloudMessage(std::span<const CloudPoint> points, int64_t utime) {
  foxglove::PointCloud cloud = NewCloud(utime);
  FieldList fields(&cloud);
  fields.AddPosition();
  fields.AddColor();
  fields.Add("segment", Field::UINT32, 4);
  fields.Add("instance", Field::UINT32, 4);
  fields.Add("class", Field::UINT16, 2);
  fields.Add("seen", Field::UINT16, 2);
  cloud.set_point_stride(fields.stride());
  std::string* data = cloud.mutable_data();
  data->reserve(points.size() * fields.stride());
  for (const CloudPoint& point : points) {
    AppendPosition(point.position_W, data);
    AppendColor(point.color, 255, data);
    AppendNumber(Raw(point.segment), data);
    AppendNumber(Raw(point.instance), data);
    AppendNumber(Raw(point.class_id), data);
    AppendNumber(uint16_t{point.seen}, data);
  }
  return EncodeFoxglove(cloud);
}

FoxgloveMessage ObjectsMessage(const ObjectList& list, const ClassNamer& class_name,
                               int64_t log_us) {
  foxglove::SceneUpdate update;
  DeleteAll(log_us, &update);
  for (const ObjectSummary& object : list.objects) {
    if (object.removed()) continue;
    foxglove::SceneEntity* entity = AddEntity(ObjectId(object), log_us, &update);
    AddObjectMetadata(object, class_name, entity);
    AddBox(object, class_name, entity);
  }
  return EncodeFoxglove(update);
}

FoxgloveMessage CellsMessage(const OccupancyMap& map, CellState state, int64_t utime) {
  foxglove::PointCloud cloud = NewCloud(utime);
  FieldList fields(&cloud);
  fields.AddPosition();
  fields.AddColor();
  fields.Add("size", Field::FLOAT32, 4);
  cloud.set_point_stride(fields.stride());
  std::string* data = cloud.mutable_data();
  ForEachCell(map, state, [&](const Eigen::Vector3f& center_W) {
    AppendPosition(center_W, data);
    AppendColor(ColorOf(state), AlphaOf(state), data);
    AppendNumber(static_cast<float>(map.cell_size()), data);
  });
  return EncodeFoxglove(cloud);
}

FoxgloveMessage GroundGridMessage(const GridMessage& message) {
  const GroundGrid& grid = message.grid;
  foxglove::Grid out;
  SetTime(message.utime, out.mutable_timestamp());
  out.set_frame_id(kWorldFrame);
  SetPose({grid.origin_W.x(), grid.origin_W.y(), MedianHeight(grid.floor_m)},
          Eigen::Quaterniond::Identity(), out.mutable_pose());
  out.set_column_count(static_cast<uint32_t>(grid.width));
  out.mutable_cell_size()->set_x(grid.resolution_m);
  out.mutable_cell_size()->set_y(grid.resolution_m);
  FieldList fields(&out);
  fields.AddColor();
  fields.Add("distance_m", Field::FLOAT32, 4);
  fields.Add("floor_m", Field::FLOAT32, 4);
  fields.Add("state", Field::UINT32, 4);
  out.set_cell_stride(fields.stride());
  out.set_row_stride(fields.stride() * static_cast<uint32_t>(grid.width));
  std::string* data = out.mutable_data();
  for (size_t i = 0; i < grid.states.size(); ++i) {
    AppendColor(ColorOf(grid.states[i]), AlphaOf(grid.states[i]), data);
    AppendNumber(grid.distances_m[i], data);
    AppendNumber(grid.floor_m[i], data);
    AppendNumber(uint32_t{static_cast<uint8_t>(grid.states[i])}, data);
  }
  return EncodeFoxglove(out);
}

}  // namespace vismap
