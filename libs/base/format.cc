#include "base/format.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace vismap {
namespace {

struct Unit {
  double size;
  const char* name;
};

// Three significant digits, without zeros at the end: 2.04, 31.8, 117, 1.2.
std::string ThreeDigits(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

// The value in the largest unit of which it holds at least one; units ascend. What rounds to 1000
// of a unit is one of the next.
template <size_t kUnits>
std::string InUnits(double value, const std::array<Unit, kUnits>& units) {
  size_t unit = 0;
  while (unit + 1 < kUnits && value >= 0.9995 * units[unit + 1].size) ++unit;
  return ThreeDigits(value / units[unit].size) + " " + units[unit].name;
}

// "3 min 20 s"; the smaller unit is left out when there is none of it.
std::string TwoUnits(int64_t small, int64_t small_per_large, const char* large_unit,
                     const char* small_unit) {
  const int64_t rest = small % small_per_large;
  return std::to_string(small / small_per_large) + " " + large_unit +
         (rest > 0 ? " " + std::to_string(rest) + " " + small_unit : "");
}

}  // namespace

std::string FormatDuration(double seconds) {
  if (!std::isfinite(seconds)) return std::isnan(seconds) ? "unknown time" : "unlimited time";
  if (seconds < 0) return "-" + FormatDuration(-seconds);
  if (seconds == 0) return "0 s";
  if (seconds >= 1e15) return ThreeDigits(seconds) + " s";
  if (seconds >= 3599.5) return TwoUnits(std::llround(seconds / 60), 60, "h", "min");
  if (seconds >= 99.95) return TwoUnits(std::llround(seconds), 60, "min", "s");
  static constexpr std::array<Unit, 4> kUnits{{{1e-9, "ns"}, {1e-6, "µs"}, {1e-3, "ms"}, {1, "s"}}};
  return InUnits(seconds, kUnits);
}

std::string FormatBytes(double bytes) {
  if (bytes < 999.5) return FormatCount(std::llround(bytes), "byte");
  static constexpr std::array<Unit, 4> kUnits{
      {{1e3, "kB"}, {1e6, "MB"}, {1e9, "GB"}, {1e12, "TB"}}};
  return InUnits(bytes, kUnits);
}

std::string FormatCount(int64_t count) {
  std::string digits = std::to_string(count);
  const size_t begin = count < 0 ? 1 : 0;
  for (size_t at = digits.size(); at > begin + 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string FormatCount(int64_t count, std::string_view singular, std::string_view plural) {
  std::string text = FormatCount(count) + " ";
  if (count == 1 || plural.empty()) {
    text += singular;
    return count == 1 ? text : text + "s";
  }
  return text.append(plural);
}

std::string FormatPercent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g %%", share * 100);
  return text;
}

}  // namespace vismap
