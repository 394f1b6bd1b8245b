#include "wire/distance_update.h"

#include <utility>

#include "freespace/shortest_text.h"

namespace vismap {
namespace {

constexpr double kLargestLeaf = 1000, kLargestLimit = 1e6;  // [m]

Result<void> CheckDistanceHeader(const distance_field_t& message) {
  if (message.revision < 0) return Fail("revision is negative");
  if (message.parts < 1 || message.part < 0 || message.part >= message.parts) {
    return Fail("it is part " + std::to_string(message.part) + " of " +
                std::to_string(message.parts));
  }
  if (message.encoding != distance_field_t::PAYLOAD_SQUARES_ZSTD)
    return Fail("payload encoding is " + std::to_string(message.encoding) + ", expected 1");
  if (message.n_blocks < 0 || message.n_blocks > kMaxDistanceBlocks) {
    return Fail(std::to_string(message.n_blocks) + " blocks, expected from 0 to " +
                std::to_string(kMaxDistanceBlocks));
  }
  if (!(message.resolution_m > 0 && message.resolution_m <= kLargestLeaf))
    return Fail("resolution_m: expected more than 0 and at most 1000, found " +
                ShortestText(message.resolution_m));
  if (!(message.limit_m > 0 && message.limit_m <= kLargestLimit))
    return Fail("limit_m: expected more than 0 and at most 1000000, found " +
                ShortestText(message.limit_m));
  return {};
}

}  // namespace

distance_field_t Encode(const DistanceUpdate& update) {
  distance_field_t message{};
  message.utime = update.utime;
  message.published_utime = update.published_utime;
  message.map_id = update.head.map_id;
  message.revision = update.head.revision;
  message.base_revision = update.head.full ? -1 : update.head.base_revision;
  message.full = update.head.full;
  message.part = update.head.part;
  message.parts = update.head.parts;
  message.resolution_m = update.leaf_m;
  message.limit_m = update.limit_m;
  message.n_blocks = static_cast<int32_t>(update.blocks.size());
  message.encoding = distance_field_t::PAYLOAD_SQUARES_ZSTD;
  message.payload = EncodeDistances(update.blocks);
  message.payload_size = static_cast<int32_t>(message.payload.size());
  return message;
}

Result<DistanceUpdate> Decode(const distance_field_t& message) {
  const std::string where = "distance_field_t of map '" + message.map_id + "', revision " +
                            std::to_string(message.revision) + ": ";
  if (const Result<void> checked = CheckDistanceHeader(message); !checked)
    return Fail(where + checked.error().message);
  Result<DistanceBlocks> blocks =
      DecodeDistances(message.payload, MaxDistanceBytes(static_cast<size_t>(message.n_blocks)));
  if (!blocks) return Fail(where + blocks.error().message);
  if (static_cast<int64_t>(blocks->size()) != message.n_blocks) {
    return Fail(where + "the payload has " + std::to_string(blocks->size()) +
                " blocks, the header says " + std::to_string(message.n_blocks));
  }
  return DistanceUpdate{
      {message.map_id, message.revision, message.full ? -1 : message.base_revision,
       message.full != 0, message.part, message.parts},
      message.utime,
      message.published_utime,
      message.resolution_m,
      message.limit_m,
      std::move(*blocks)};
}

}  // namespace vismap
