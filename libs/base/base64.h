#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace vismap {

/// Bytes as text, as RFC 4648 says.
std::string Base64(std::span<const uint8_t> bytes);

}  // namespace vismap
