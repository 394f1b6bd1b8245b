#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/ids.h"

namespace vismap {

/// Returns the name of a class for people; "" when it has none.
using ClassNamer = std::function<std::string(ClassId)>;

/// The COCO name of a class (official category ids 1..91), "unknown" for 0, "class N" beyond.
std::string ClassName(ClassId id);

/// The class with this COCO name in lower case ("dining table", "tv"); nullopt when there is none.
std::optional<ClassId> ClassFromName(std::string_view name);

/// A class as people write it: its COCO name, or its id in [0, 65535]; nullopt for other texts.
std::optional<ClassId> ParseClass(std::string_view text);

}  // namespace vismap
