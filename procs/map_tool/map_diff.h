#pragma once

#include <string>
#include <vector>

#include "mapfile/map_file.h"

namespace vismap {

/// One sentence for each kind of difference between two maps, general ones first; empty = the maps
/// are equal (equal hashes).
std::vector<std::string> DiffMaps(const LoadedMap& a, const LoadedMap& b);

}  // namespace vismap
