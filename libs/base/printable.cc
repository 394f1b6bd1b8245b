#include "base/printable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>

namespace vismap {
namespace {

constexpr std::string_view kCut = "...";

/// A character of a text, or one byte of it that is no UTF-8.
struct Character {
  uint32_t code = 0;
  size_t bytes = 1;
  bool valid = false;
};

bool IsContinuation(char byte) { return (static_cast<uint8_t>(byte) & 0xC0) == 0x80; }

/// The first character of a text that is not empty. Overlong forms, surrogates and numbers beyond
/// Unicode are no UTF-8.
Character FirstCharacter(std::string_view text) {
  const auto first = static_cast<uint8_t>(text[0]);
  if (first < 0x80) return {first, 1, true};
  const size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return {first};
  uint32_t code = first & (0xFFU >> (bytes + 1));
  for (size_t i = 1; i < bytes; ++i) {
    if (!IsContinuation(text[i])) return {first};
    code = code << 6 | (static_cast<uint8_t>(text[i]) & 0x3FU);
  }
  const std::array<uint32_t, 5> smallest = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < smallest[bytes] || code > 0x10FFFF || surrogate) return {first};
  return {code, bytes, true};
}

/// Controls (C0, DEL, C1), and what is invisible or changes how the text around it is shown.
bool NeedsEscape(uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0xAD || code == 0x061C ||
         code == 0x180E || (code >= 0x200B && code <= 0x200F) ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2060 && code <= 0x206F) ||
         code == 0xFEFF || (code >= 0xFFF9 && code <= 0xFFFB) || code >= 0xE0000;
}

std::string Escape(const Character& character) {
  if (character.code == '\n') return "\\n";
  if (character.code == '\r') return "\\r";
  if (character.code == '\t') return "\\t";
  const bool byte = !character.valid || character.code < 0x80;
  const char* form = byte ? "\\x%02x" : character.code > 0xFFFF ? "\\U%08x" : "\\u%04x";
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), form, character.code);
  return text.data();
}

bool IsPlainAscii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace

std::string PrintableText(std::string_view text, size_t max_bytes) {
  if (text.size() <= max_bytes && IsPlainAscii(text)) return std::string(text);
  std::string shown;
  size_t cut_at = 0;  // the most of `shown` that leaves room for kCut
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    const bool escape = !character.valid || NeedsEscape(character.code);
    shown += escape ? Escape(character) : std::string(text.substr(0, character.bytes));
    if (shown.size() > max_bytes) return shown.substr(0, cut_at).append(kCut.substr(0, max_bytes));
    if (shown.size() + kCut.size() <= max_bytes) cut_at = shown.size();
    text.remove_prefix(character.bytes);
  }
  return shown;
}

}  // namespace vismap
