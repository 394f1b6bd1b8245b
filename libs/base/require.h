#pragma once

#include <stdexcept>
#include <string>

namespace vismap {

/// Throws std::logic_error("vismap: " + what) unless `condition` holds: the caller broke the
/// contract, a bug of ours.
inline void Require(bool condition, const char* what) {
  if (!condition) throw std::logic_error(std::string("vismap: ") + what);
}

}  // namespace vismap
