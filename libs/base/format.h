#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace vismap {

// Numbers as people read them, for logs, tables and error messages. Files and JSON keep plain
// numbers.

/// A duration [s] with three significant digits and a fitting unit: "41.4 µs", "117 ms", "2.04 s",
/// "3 min 20 s", "1 h 5 min". A negative duration gets a minus sign.
std::string FormatDuration(double seconds);

/// A size [bytes] with three significant digits and a decimal unit (1 kB = 1000 bytes): "1 byte",
/// "512 bytes", "31.8 MB", "1.2 GB".
std::string FormatBytes(double bytes);
template <typename Number>
requires std::is_integral_v<Number> std::string FormatBytes(Number bytes) {
  return FormatBytes(static_cast<double>(bytes));
}

/// A whole number with a comma before each group of three digits: "7", "1,392,815".
std::string FormatCount(int64_t count);

/// A number of things: "1 frame", "20 frames", "1,392,815 triangles". `plural` is needed where it
/// is not `singular` with an "s".
std::string FormatCount(int64_t count, std::string_view singular, std::string_view plural = "");

/// A share in [0, 1] as percent, with at most four significant digits: "12.5 %".
std::string FormatPercent(double share);

}  // namespace vismap
