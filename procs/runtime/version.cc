#include "runtime/version.h"

namespace vismap {

const char* Version() { return VISMAP_VERSION; }

}  // namespace vismap
