#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vismap::mapfile {

/// About how much memory [bytes] a record with a protobuf message takes at most once it is read and
/// converted, found without reading it: an entry of a list may have two bytes in a file, but it has
/// hundreds in memory.
size_t ExpandedBytes(std::span<const uint8_t> message);

}  // namespace vismap::mapfile
