#pragma once

#include <cstdint>
#include <string>
#include <vismap/distance_field_t.hpp>

#include "navigation/distance_codec.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Largest number of blocks in one distance_field_t, 32 MB before compression. Decode rejects more.
inline constexpr int32_t kMaxDistanceBlocks = 16384;

/// The content of one distance_field_t.
struct DistanceUpdate {
  UpdateHead head;
  int64_t utime = 0;            ///< of the newest frame in the map [us]
  int64_t published_utime = 0;  ///< when it was sent [us]
  double leaf_m = 0;            ///< edge of a leaf [m]
  double limit_m = 0;           ///< distances are exact up to here [m]
  DistanceBlocks blocks;
};

distance_field_t Encode(const DistanceUpdate& update);

/// Fails, naming the field, on every value that Encode does not produce.
Result<DistanceUpdate> Decode(const distance_field_t& message);

}  // namespace vismap
