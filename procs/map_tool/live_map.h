#pragma once

#include <string>
#include <vismap/map_request_t.hpp>

#include "map_tool/commands.h"
#include "map_tool/server_client.h"
#include "mapfile/map_file.h"

namespace vismap {

/// Stands for the map of a running server where a map file is expected.
inline constexpr const char* kLive = "live";

/// Sends a request to the running server and returns its answer, or the reason to exit.
tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         map_request_t request);
tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         const std::string& verb,
                                                         const std::string& path = "",
                                                         const std::string& argument = "");

/// A saved map, or the reason to exit.
tl::expected<LoadedMap, ExitFailure> LoadSavedMap(const MapToolArguments& arguments);

/// The same, or the map of the running server.
tl::expected<LoadedMap, ExitFailure> LoadMapOrLive(const MapToolArguments& arguments,
                                                   ProcessContext& context);

/// The payload of an answer as text.
std::string PayloadText(const map_reply_t& reply);

}  // namespace vismap
