#pragma once

#include <array>
#include <charconv>
#include <string>

namespace vismap {

/// The shortest text that reads back as the same number.
inline std::string ShortestText(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

}  // namespace vismap
