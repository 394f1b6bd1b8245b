#include "wire/older_mesh.h"

#include <algorithm>
#include <iterator>

namespace vismap {
namespace {

mesh_block_t ToCurrentVersion(const mesh_block_v1_t& older) {
  mesh_block_t block{};
  std::copy(std::begin(older.index), std::end(older.index), std::begin(block.index));
  block.edge_m = older.edge_m;
  block.n_vertices = older.n_vertices;
  block.x = older.x;
  block.y = older.y;
  block.z = older.z;
  block.nx = older.nx;
  block.ny = older.ny;
  block.nz = older.nz;
  block.red = older.red;
  block.green = older.green;
  block.blue = older.blue;
  block.segment = older.segment;
  block.instance = older.instance;
  block.class_id = older.class_id;
  block.n_triangles = older.n_triangles;
  block.a = older.a;
  block.b = older.b;
  block.c = older.c;
  block.seen.resize(older.x.size());
  return block;
}

}  // namespace

mesh_delta_t ToCurrentVersion(const mesh_delta_v1_t& older) {
  mesh_delta_t message{};
  message.utime = older.utime;
  message.seq = older.seq;
  message.source = older.source;
  message.map_id = older.map_id;
  message.revision = older.revision;
  message.base_revision = older.base_revision;
  message.full = older.full;
  message.part = older.part;
  message.parts = older.parts;
  message.n_blocks = older.n_blocks;
  for (const mesh_block_v1_t& block : older.blocks)
    message.blocks.push_back(ToCurrentVersion(block));
  return message;
}

}  // namespace vismap
