#include "wire/update_sequence.h"

#include <charconv>

namespace vismap {

std::string ToText(const FollowerPosition& position) {
  return position.revision < 0 ? "" : position.map_id + "@" + std::to_string(position.revision);
}

Result<FollowerPosition> ParseFollowerPosition(const std::string& text) {
  FollowerPosition position;
  if (text.empty()) return position;
  const size_t at = text.rfind('@');
  if (at != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + at + 1, end, position.revision);
    position.map_id = text.substr(0, at);
    if (error == std::errc() && stop == end && position.revision >= 0) return position;
  }
  return Fail("position '" + text + "': expected MAP_ID@REVISION or an empty string");
}

}  // namespace vismap
