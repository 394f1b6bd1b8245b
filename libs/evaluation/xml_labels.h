#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap {

/// The attributes of all `<label .../>` elements of an XML text, in order; of the rest of XML only
/// comments and the five named entities are understood. `name` opens the error sentence. Fails on
/// an element that is cut short or an attribute that is not NAME="VALUE".
Result<std::vector<std::map<std::string, std::string>>> ParseXmlLabels(std::string_view text,
                                                                       const std::string& name);

}  // namespace vismap
