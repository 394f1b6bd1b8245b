#pragma once

#include <vismap/map_reply_t.hpp>
#include <vismap/map_reply_v1_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/map_request_v1_t.hpp>
#include <vismap/octree_t.hpp>
#include <vismap/octree_v1_t.hpp>

namespace vismap {

/// The same octree. A closed one of the first version has no shell, and the time of publishing is
/// not known: 0.
octree_t ToCurrentVersion(const octree_v1_t& older);
/// The same request. UNKNOWN_DEFAULT stays, and now means a closed octree.
map_request_t ToCurrentVersion(const map_request_v1_t& older);
/// The same reply; it states nothing about an octree.
map_reply_t ToCurrentVersion(const map_reply_v1_t& older);

}  // namespace vismap
