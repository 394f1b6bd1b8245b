#pragma once

#include <vismap/mesh_delta_t.hpp>
#include <vismap/mesh_delta_v1_t.hpp>

namespace vismap {

/// The message of the first version in the current version: how often the surface was seen is not
/// known.
mesh_delta_t ToCurrentVersion(const mesh_delta_v1_t& older);

}  // namespace vismap
