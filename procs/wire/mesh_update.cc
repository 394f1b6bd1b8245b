#include "wire/mesh_update.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"

namespace vismap {
namespace {

// Rounds to the nearest integer, halves away from zero.
int32_t Round(float value) {
  return static_cast<int32_t>(static_cast<double>(value) + (value < 0 ? -0.5 : 0.5));
}

int16_t Quantise(float offset_in_edges) {  // from the lower corner of the block, in [-0.5, 1.5]
  const float steps = std::clamp((offset_in_edges + 0.5F) / 2.0F * 65535.0F, 0.0F, 65535.0F);
  return static_cast<int16_t>(static_cast<uint16_t>(Round(steps)));
}

float Restore(int16_t quantised) {
  return static_cast<float>(static_cast<uint16_t>(quantised)) * 2.0F / 65535.0F - 0.5F;
}

int8_t QuantiseNormal(float component) {
  return static_cast<int8_t>(Round(std::clamp(component, -1.0F, 1.0F) * 127.0F));
}

// Fills one array of a message with get(element) of each element.
template <typename Element, typename Number, typename Get>
void Fill(const std::vector<Element>& elements, std::vector<Number>* numbers, const Get& get) {
  numbers->resize(elements.size());
  for (size_t i = 0; i < elements.size(); ++i)
    (*numbers)[i] = static_cast<Number>(get(elements[i]));
}

void EncodeVertices(const BlockMesh& block, double block_size, mesh_block_t* message) {
  const std::vector<MeshVertex>& vertices = block.mesh.vertices;
  const std::array<int32_t, 3> index{block.block.x, block.block.y, block.block.z};
  const std::array positions{&message->x, &message->y, &message->z};
  const std::array normals{&message->nx, &message->ny, &message->nz};
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto component = static_cast<Eigen::Index>(axis);
    const double corner = index[axis] * block_size;
    Fill(vertices, positions[axis], [&](const MeshVertex& v) {
      const double offset = static_cast<double>(v.position_W[component]) - corner;
      return Quantise(static_cast<float>(offset / block_size));
    });
    Fill(vertices, normals[axis],
         [&](const MeshVertex& v) { return QuantiseNormal(v.normal_W[component]); });
  }
  Fill(vertices, &message->red, [](const MeshVertex& v) { return v.color.r; });
  Fill(vertices, &message->green, [](const MeshVertex& v) { return v.color.g; });
  Fill(vertices, &message->blue, [](const MeshVertex& v) { return v.color.b; });
  Fill(vertices, &message->segment, [](const MeshVertex& v) { return Raw(v.segment); });
  Fill(vertices, &message->instance, [](const MeshVertex& v) { return Raw(v.instance); });
  Fill(vertices, &message->class_id, [](const MeshVertex& v) { return Raw(v.class_id); });
  Fill(vertices, &message->seen, [](const MeshVertex& v) { return v.seen; });
  message->n_vertices = static_cast<int32_t>(vertices.size());
}

mesh_block_t EncodeBlock(const BlockMesh& block, double block_size) {
  mesh_block_t message{};
  message.index[0] = block.block.x;
  message.index[1] = block.block.y;
  message.index[2] = block.block.z;
  message.edge_m = static_cast<float>(block_size);
  EncodeVertices(block, block_size, &message);
  using Triangle = std::array<uint32_t, 3>;
  const std::vector<Triangle>& triangles = block.mesh.triangles;
  Fill(triangles, &message.a, [](const Triangle& corners) { return corners[0]; });
  Fill(triangles, &message.b, [](const Triangle& corners) { return corners[1]; });
  Fill(triangles, &message.c, [](const Triangle& corners) { return corners[2]; });
  message.n_triangles = static_cast<int32_t>(triangles.size());
  return message;
}

MeshVertex DecodeVertex(const mesh_block_t& message, const Eigen::Vector3d& corner, double edge,
                        size_t i) {
  MeshVertex vertex;
  const Eigen::Vector3d offset(Restore(message.x[i]), Restore(message.y[i]), Restore(message.z[i]));
  vertex.position_W = (corner + offset * edge).cast<float>();
  const Eigen::Vector3f normal(message.nx[i], message.ny[i], message.nz[i]);
  vertex.normal_W =
      normal.norm() > 0 ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::Zero();
  vertex.color = {message.red[i], message.green[i], message.blue[i]};
  vertex.segment = static_cast<SegmentLabel>(message.segment[i]);
  vertex.instance = static_cast<InstanceId>(message.instance[i]);
  vertex.class_id = static_cast<ClassId>(message.class_id[i]);
  vertex.seen = message.seen[i];
  return vertex;
}

Result<void> Check(const mesh_block_t& message) {
  const auto where = [&] {
    return "block (" + std::to_string(message.index[0]) + ", " + std::to_string(message.index[1]) +
           ", " + std::to_string(message.index[2]) + "): ";
  };
  const double edge = message.edge_m;
  if (!(edge > 0 && edge < 1e3)) return Fail(where() + "edge_m must be in (0, 1000) m");
  for (const std::vector<int32_t>* corners : {&message.a, &message.b, &message.c}) {
    for (const int32_t index : *corners) {
      if (index < 0 || index >= message.n_vertices) {
        return Fail(where() + "a triangle refers to vertex " + std::to_string(index) +
                    ", but there are " + std::to_string(message.n_vertices) + " vertices");
      }
    }
  }
  return {};
}

BlockIndex IndexOf(const mesh_block_t& message) {
  return {message.index[0], message.index[1], message.index[2]};
}

}  // namespace

Result<BlockMesh> Decode(const mesh_block_t& message) {
  if (Result<void> checked = Check(message); !checked) return tl::unexpected(checked.error());
  BlockMesh block{IndexOf(message), {}};
  const double edge = message.edge_m;
  const Eigen::Vector3d corner =
      Eigen::Vector3d(block.block.x, block.block.y, block.block.z) * edge;
  const auto count = static_cast<size_t>(message.n_vertices);
  block.mesh.vertices.reserve(count);
  for (size_t i = 0; i < count; ++i)
    block.mesh.vertices.push_back(DecodeVertex(message, corner, edge, i));
  const auto triangles = static_cast<size_t>(message.n_triangles);
  block.mesh.triangles.reserve(triangles);
  for (size_t i = 0; i < triangles; ++i) {
    block.mesh.triangles.push_back({static_cast<uint32_t>(message.a[i]),
                                    static_cast<uint32_t>(message.b[i]),
                                    static_cast<uint32_t>(message.c[i])});
  }
  return block;
}

mesh_delta_t Encode(const MeshUpdate& update) {
  mesh_delta_t message{};
  message.utime = update.utime;
  message.map_id = update.map_id;
  message.revision = update.mesh.revision;
  message.base_revision = update.full ? -1 : update.base_revision;
  message.full = update.full;
  message.part = update.part;
  message.parts = update.parts;
  const std::vector<BlockMesh>& blocks = update.mesh.blocks;
  message.blocks.resize(blocks.size());
  ParallelFor(blocks.size(), 16,
              [&](size_t i) { message.blocks[i] = EncodeBlock(blocks[i], update.block_size); });
  message.n_blocks = static_cast<int32_t>(message.blocks.size());
  return message;
}

Result<void> Check(const mesh_delta_t& message) {
  const auto where = [&] {
    return "mesh_delta_t of map '" + message.map_id + "', revision " +
           std::to_string(message.revision) + ": ";
  };
  if (message.parts < 1 || message.part < 0 || message.part >= message.parts) {
    return Fail(where() + "it is part " + std::to_string(message.part) + " of " +
                std::to_string(message.parts));
  }
  const mesh_block_t* last = nullptr;
  for (const mesh_block_t& block : message.blocks) {
    if (Result<void> checked = Check(block); !checked)
      return Fail(where() + checked.error().message);
    if (last != nullptr && !(IndexOf(*last) < IndexOf(block)))
      return Fail(where() + "the blocks are not in ascending order");
    last = &block;
  }
  return {};
}

Result<MeshUpdate> Decode(const mesh_delta_t& message) {
  if (Result<void> checked = Check(message); !checked) return tl::unexpected(checked.error());
  MeshUpdate update{message.utime,
                    message.map_id,
                    message.base_revision,
                    static_cast<bool>(message.full),
                    message.part,
                    message.parts,
                    0,
                    {message.revision, {}}};
  for (const mesh_block_t& block : message.blocks) {
    update.block_size = block.edge_m;
    update.mesh.blocks.push_back(std::move(*Decode(block)));
  }
  return update;
}

}  // namespace vismap
