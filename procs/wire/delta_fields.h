#pragma once

#include <string>
#include <utility>

#include "freespace/occupancy_codec.h"
#include "wire/map_update.h"

namespace vismap {

// The fields that map_delta_t and octree_delta_t share. Their cells are voxels and leaves.

/// Sets all fields of an update but the size of its cells.
template <typename Message>
void SetDeltaFields(const MapUpdate& update, Message* message) {
  message->utime = update.utime;
  message->map_id = update.map_id;
  message->revision = update.revision;
  message->base_revision = update.delta.complete ? -1 : update.base_revision;
  message->full = update.delta.complete;
  message->part = update.part;
  message->parts = update.parts;
  message->n_blocks = static_cast<int32_t>(update.delta.blocks.size());
  message->encoding = Message::PAYLOAD_STATES_ZSTD;
  message->payload = EncodeOccupancyDelta(update.delta);
  message->payload_size = static_cast<int32_t>(message->payload.size());
}

/// Fails, naming the field, on every value that SetDeltaFields does not produce, and when the
/// payload has cells of another size than `cell_size` [m].
template <typename Message>
Result<MapUpdate> ReadDeltaFields(const Message& message, double cell_size) {
  const std::string where = std::string(Message::getTypeName()) + " of map '" + message.map_id +
                            "', revision " + std::to_string(message.revision) + ": ";
  if (message.revision < 0) return Fail(where + "revision is negative");
  if (message.parts < 1 || message.part < 0 || message.part >= message.parts) {
    return Fail(where + "it is part " + std::to_string(message.part) + " of " +
                std::to_string(message.parts));
  }
  if (message.encoding != Message::PAYLOAD_STATES_ZSTD) {
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
  if (delta->voxel_size != cell_size)
    return Fail(where + "the sizes of cells in header and payload differ");
  if (static_cast<int64_t>(delta->blocks.size()) != message.n_blocks) {
    return Fail(where + "the payload has " + std::to_string(delta->blocks.size()) +
                " blocks, the header says " + std::to_string(message.n_blocks));
  }
  return MapUpdate{message.utime, message.map_id, message.revision, message.base_revision,
                   message.part,  message.parts,  std::move(*delta)};
}

}  // namespace vismap
