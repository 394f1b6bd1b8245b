#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "base/result.h"

namespace vismap {

/// How much memory the values of a JSON text may need, by default [bytes].
inline constexpr size_t kMaxJsonMemory = size_t{1} << 30;

/// Reads JSON from an untrusted source. Fails with line and column when the text is not JSON, and
/// when it is nested deeper than 64 levels, since code that visits or prints deeper values would
/// overflow the stack. A short text can hold very many values; when they would need more than about
/// `max_memory` bytes, it fails before it creates them. `Json` is nlohmann::json or
/// nlohmann::ordered_json.
template <typename Json = nlohmann::json>
Result<Json> ParseJson(std::string_view text, size_t max_memory = kMaxJsonMemory);

/// Describes a value for error messages: "an object", "an array of 3 values", the number itself, or
/// the first characters of a text without control characters. At most 60 characters.
std::string DescribeJson(const nlohmann::json& value);

extern template Result<nlohmann::json> ParseJson<nlohmann::json>(std::string_view, size_t);
extern template Result<nlohmann::ordered_json> ParseJson<nlohmann::ordered_json>(std::string_view,
                                                                                 size_t);

}  // namespace vismap
