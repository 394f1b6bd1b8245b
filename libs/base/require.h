#pragma once

#include <stdexcept>
#include <string>

namespace vismap {

/// Throws std::logic_error("vismap: " + what) unless `condition` holds. For errors of the program
/// itself; `what` says what must hold.
inline void Require(bool condition, const char* what) {
  if (!condition) throw std::logic_error(std::string("vismap: ") + what);
}

}  // namespace vismap
