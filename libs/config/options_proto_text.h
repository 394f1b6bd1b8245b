#pragma once

namespace vismap::config {

/// The whole of options.proto, with its comments.
extern const char* const kOptionsProtoText;

}  // namespace vismap::config
