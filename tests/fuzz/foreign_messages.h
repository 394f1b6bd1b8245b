#pragma once

#include <vector>

#include "hostile_messages.h"

namespace vismap {

/// Targets for the messages of other robots' programs that the adapter reads.
std::vector<FuzzTarget> ForeignFuzzTargets();

}  // namespace vismap
