#include "wire/map_update.h"

#include <algorithm>

#include "wire/delta_fields.h"

namespace vismap {

map_delta_t Encode(const MapUpdate& update) {
  map_delta_t message{};
  SetDeltaFields(update, &message);
  message.voxel_size_m = update.delta.voxel_size;
  return message;
}

Result<MapUpdate> Decode(const map_delta_t& message) {
  return ReadDeltaFields(message, message.voxel_size_m);
}

std::vector<MapUpdate> SplitUpdate(MapUpdate update, size_t max_blocks) {
  const size_t count = update.delta.blocks.size();
  const size_t parts = std::max<size_t>(1, (count + max_blocks - 1) / max_blocks);
  std::vector<MapUpdate> split;
  for (size_t part = 0; part < parts; ++part) {
    MapUpdate piece{update.utime,
                    update.map_id,
                    update.revision,
                    update.base_revision,
                    static_cast<int32_t>(part),
                    static_cast<int32_t>(parts),
                    {update.delta.voxel_size, update.delta.complete, {}}};
    const auto begin = update.delta.blocks.begin() + static_cast<std::ptrdiff_t>(part * max_blocks);
    const auto end = update.delta.blocks.begin() +
                     static_cast<std::ptrdiff_t>(std::min(count, (part + 1) * max_blocks));
    piece.delta.blocks.assign(begin, end);
    split.push_back(std::move(piece));
  }
  return split;
}

}  // namespace vismap
