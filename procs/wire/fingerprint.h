#pragma once

#include <cstdint>

namespace vismap {

/// One number for the layout of all message types: processes with different ones cannot talk to
/// each other.
int64_t TypesFingerprint();

}  // namespace vismap
