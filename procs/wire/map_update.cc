#include "wire/map_update.h"

#include <algorithm>

#include "freespace/occupancy_codec.h"

namespace vismap {

map_delta_t Encode(const MapUpdate& update) {
  map_delta_t message{};
  message.utime = update.utime;
  message.map_id = update.map_id;
  message.revision = update.revision;
  message.base_revision = update.delta.complete ? -1 : update.base_revision;
  message.full = update.delta.complete;
  message.part = update.part;
  message.parts = update.parts;
  message.voxel_size_m = update.delta.voxel_size;
  message.n_blocks = static_cast<int32_t>(update.delta.blocks.size());
  message.encoding = map_delta_t::PAYLOAD_STATES_ZSTD;
  message.payload = EncodeOccupancyDelta(update.delta);
  message.payload_size = static_cast<int32_t>(message.payload.size());
  return message;
}

Result<MapUpdate> Decode(const map_delta_t& message) {
  const std::string where = "map_delta_t of map '" + message.map_id + "', revision " +
                            std::to_string(message.revision) + ": ";
  if (message.revision < 0) return Fail(where + "revision is negative");
  if (message.parts < 1 || message.part < 0 || message.part >= message.parts) {
    return Fail(where + "it is part " + std::to_string(message.part) + " of " +
                std::to_string(message.parts));
  }
  if (message.encoding != map_delta_t::PAYLOAD_STATES_ZSTD) {
    return Fail(where + "payload encoding is " + std::to_string(message.encoding) + ", expected 1");
  }
  if (message.n_blocks < 0 || message.n_blocks > kMaxBlocksPerUpdate) {
    return Fail(where + std::to_string(message.n_blocks) + " blocks, expected from 0 to " +
                std::to_string(kMaxBlocksPerUpdate));
  }
  Result<OccupancyDelta> delta = DecodeOccupancyDelta(
      message.payload, MaxOccupancyDeltaBytes(static_cast<size_t>(message.n_blocks)));
  if (!delta) return Fail(where + delta.error().message);
  if (delta->complete != static_cast<bool>(message.full))
    return Fail(where + "the header says full = " + std::to_string(message.full) +
                ", the payload says the opposite");
  if (delta->voxel_size != message.voxel_size_m)
    return Fail(where + "the voxel sizes in header and payload differ");
  if (static_cast<int64_t>(delta->blocks.size()) != message.n_blocks) {
    return Fail(where + "the payload has " + std::to_string(delta->blocks.size()) +
                " blocks, the header says " + std::to_string(message.n_blocks));
  }
  return MapUpdate{message.utime, message.map_id, message.revision, message.base_revision,
                   message.part,  message.parts,  std::move(*delta)};
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
