#pragma once

#include <nlohmann/json.hpp>

namespace vismap {

/// Prints the content of objects.json as a table for people: the objects; with `all` also the
/// discovered segments one by one, structure included, else only their number; what was removed.
void PrintObjects(const nlohmann::json& list, bool all);

}  // namespace vismap
