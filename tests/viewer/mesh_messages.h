#pragma once

#include <string>
#include <vector>
#include <vismap/mesh_delta_t.hpp>

namespace vismap::testing_support {

/// A block with `triangles` triangles of three vertices each; 0 = the block lost its surface.
/// Blocks with another `look` differ.
inline mesh_block_t SomeBlock(int x, int y, int z, int triangles, int look = 0) {
  mesh_block_t block{};
  block.index[0] = x;
  block.index[1] = y;
  block.index[2] = z;
  block.edge_m = 0.5F;
  block.n_triangles = triangles;
  block.n_vertices = 3 * triangles;
  for (int i = 0; i < block.n_vertices; ++i) {
    block.x.push_back(static_cast<int16_t>(40000 + i));  // read as unsigned
    block.y.push_back(static_cast<int16_t>(2 * i));
    block.z.push_back(static_cast<int16_t>(look));
    block.nx.push_back(static_cast<int8_t>(-127 + i));
    block.ny.push_back(static_cast<int8_t>(i));
    block.nz.push_back(0);
    block.red.push_back(static_cast<uint8_t>(10 + i));
    block.green.push_back(20);
    block.blue.push_back(30);
    block.segment.push_back(100000 + i);
    block.instance.push_back(7);
    block.class_id.push_back(62);
    block.seen.push_back(static_cast<uint8_t>(200 + i));
  }
  for (int i = 0; i < triangles; ++i) {
    block.a.push_back(3 * i);
    block.b.push_back(3 * i + 1);
    block.c.push_back(3 * i + 2);
  }
  return block;
}

/// An update of one part. `base` < 0: a snapshot.
inline mesh_delta_t SomeUpdate(const std::string& map_id, int64_t base, int64_t revision,
                               std::vector<mesh_block_t> blocks) {
  mesh_delta_t message{};
  message.utime = 1000 * revision;
  message.map_id = map_id;
  message.revision = revision;
  message.base_revision = base;
  message.full = base < 0;
  message.parts = 1;
  message.blocks = std::move(blocks);
  message.n_blocks = static_cast<int32_t>(message.blocks.size());
  return message;
}

}  // namespace vismap::testing_support
