#pragma once

#include <vector>
#include <vismap/map_request_t.hpp>

#include "base/result.h"
#include "viewer/slice.h"
#include "wire/distance_update.h"

namespace vismap {

/// The request to the octomap exporter for the distances in a slice.
map_request_t DistanceRequest(const Slice& slice, const SliceQuestion& question);

/// Distances of a slice's cells to the nearest occupied leaf of the map, in all three directions.
struct SliceDistances {
  double leaf_m = 0;
  double limit_m = 0;  ///< larger ones are this
  /// Of the cells' centres [m], in the order of Slice::states: between the centres of leaves in the
  /// plane linear. NaN in leaves that are unknown.
  std::vector<float> metres;
};
/// From the payload of the exporter's answer. Fails when it is damaged.
Result<SliceDistances> ReadDistances(const std::vector<uint8_t>& payload, const Slice& slice,
                                     const SliceQuestion& question);
SliceDistances DistancesOf(const Slice& slice, const SliceQuestion& question,
                           const DistanceUpdate& update);

}  // namespace vismap
