#pragma once

namespace vismap {

/// Version of vismap, for example "0.1.0".
const char* Version();

}  // namespace vismap
