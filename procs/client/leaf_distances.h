#pragma once

#include "client/navigation.h"
#include "wire/distance_follower.h"

namespace vismap {

/// What a LeafDistances shares with its copies.
struct LeafDistances::Field {
  double leaf_m = 0, limit_m = 0;
  SharedDistanceBlocks blocks;
};

}  // namespace vismap
