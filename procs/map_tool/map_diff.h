#pragma once

#include <string>
#include <vector>

#include "mapfile/map_file.h"

namespace vismap {

/// In what two maps differ, one sentence each, the general ones first; empty = they are equal
/// (equal hashes).
std::vector<std::string> DiffMaps(const LoadedMap& a, const LoadedMap& b);

}  // namespace vismap
