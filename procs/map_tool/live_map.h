#pragma once

#include <string>
#include <vismap/map_request_t.hpp>

#include "map_tool/commands.h"
#include "map_tool/server_client.h"

namespace vismap {

/// What stands for a map file when the map of a running server is meant.
inline constexpr const char* kLive = "live";

/// The answer of a running server to a request, or why the program ends.
tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         map_request_t request);
tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         const std::string& verb,
                                                         const std::string& path = "",
                                                         const std::string& argument = "");

/// The payload of an answer as text.
std::string PayloadText(const map_reply_t& reply);

}  // namespace vismap
