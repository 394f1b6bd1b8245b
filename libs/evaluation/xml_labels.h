#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap {

/// The attributes of all `<label .../>` elements of an XML text, in their order. Of the rest of
/// XML, only comments and the five named entities are supported. `name` is the file's name in
/// errors. Fails on a truncated element and on an attribute that is not NAME="VALUE".
Result<std::vector<std::map<std::string, std::string>>> ParseXmlLabels(std::string_view text,
                                                                       const std::string& name);

}  // namespace vismap
