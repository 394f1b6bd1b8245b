#pragma once

#include <string_view>

namespace vismap {

/// The text without the UTF-8 byte order mark that editors on Windows put at the beginning of
/// files.
inline std::string_view WithoutByteOrderMark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

}  // namespace vismap
