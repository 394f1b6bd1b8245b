#pragma once

#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/octree_t.hpp>

#include "client/navigation.h"

namespace vismap {

/// The channel of a tree. Throws std::invalid_argument when there is no such kind.
std::string ChannelOf(TreeKind kind);

/// Why a tree must not be handed out: it is damaged, empty, or raw on the channel of a closed one.
/// "" = it may be.
std::string ProblemOf(TreeKind kind, const octree_t& tree);

/// What a reply carries, as on OCTOMAP.
octree_t TreeOf(map_reply_t reply);

/// Whether two trees say the same of the same map.
bool OfOneState(const octree_t& a, const octree_t& b);

}  // namespace vismap
