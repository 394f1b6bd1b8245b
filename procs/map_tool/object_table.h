#pragma once

#include <string>

namespace vismap {

/// Prints the text of an objects.json as a table for people: the objects; with `all` also the
/// discovered segments one by one, structure included, else only their number; what was removed.
void PrintObjects(const std::string& objects_json, bool all);

}  // namespace vismap
