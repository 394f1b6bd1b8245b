#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "map_tool/commands.h"

namespace vismap {

/// Prints an answer in JSON as it is with --json, else by `print`. Fails with the answer's own
/// failure, and when the JSON cannot be read or lacks what `print` looks for.
Outcome PrintAnswer(const MapToolArguments& arguments,
                    const tl::expected<std::string, ExitFailure>& text,
                    void (*print)(const nlohmann::json&));

}  // namespace vismap
