#include "map_tool/print_answer.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/json_text.h"

namespace vismap {

Outcome PrintAnswer(const MapToolArguments& arguments,
                    const tl::expected<std::string, ExitFailure>& text,
                    void (*print)(const nlohmann::json&)) {
  if (!text) return tl::unexpected(text.error());
  if (arguments.json) {
    std::printf("%s\n", text->c_str());
    return {};
  }
  const Result<nlohmann::json> json = ParseJson(*text);
  if (!json) return ExitWith(ExitCode::kFailed, "the answer: " + json.error().message);
  try {
    print(*json);
  } catch (const nlohmann::json::exception& error) {
    return ExitWith(ExitCode::kFailed, "the answer lacks something: " + std::string(error.what()));
  }
  return {};
}

}  // namespace vismap
