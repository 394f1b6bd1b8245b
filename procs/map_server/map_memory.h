#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "map_server/map_publisher.h"
#include "session/map_session.h"

namespace vismap {

/// Memory that a map takes, and what a server keeps besides to publish it.
struct MemoryLayer {
  const char* name;  ///< such as "distances"
  size_t bytes;
};

/// By layer, always the same ones in the same order. It looks at every block, which takes some
/// milliseconds for a large map. `copies`: copies of the map that others read at present; what a
/// copy shares with the map is not counted twice.
std::vector<MemoryLayer> MeasureLayers(const MapSession& session, MapPublisher& publisher,
                                       size_t copies);

/// {"distances": bytes, ...}
nlohmann::ordered_json ToJson(const std::vector<MemoryLayer>& layers);

}  // namespace vismap
