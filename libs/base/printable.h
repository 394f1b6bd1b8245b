#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vismap {

/// A text from outside (a message, a name, a file) as it may stand in a log, a reply or on a
/// terminal: one line of valid UTF-8. Control characters, bytes that are no UTF-8, and characters
/// that are invisible or change the direction of writing become escapes such as \n, \x1b and
/// \u202e; all other text stays as it is. A result of more than `max_bytes` is cut and then ends
/// with "...". Applying the function again changes nothing.
std::string PrintableText(std::string_view text, size_t max_bytes = 1000);

}  // namespace vismap
