#pragma once

#include <string>

namespace vismap {

/// Prints the text of an objects.json as a table for people. The table has the objects and the
/// removed objects. With `all` it also has every discovered segment, including structure; otherwise
/// only their number is printed.
void PrintObjects(const std::string& objects_json, bool all);

}  // namespace vismap
