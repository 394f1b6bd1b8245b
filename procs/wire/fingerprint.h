#pragma once

#include <cstdint>

namespace vismap {

/// One number for the layouts of all message types. Two processes with different numbers cannot
/// decode all of each other's messages.
int64_t TypesFingerprint();

}  // namespace vismap
