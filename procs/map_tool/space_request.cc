#include "map_tool/space_request.h"

#include <algorithm>
#include <utility>

#include "exports/outputs.h"
#include "navigation/overlay.h"
#include "objects/object_query.h"
#include "requests/object_edits.h"

namespace vismap {

namespace {

int8_t PolicyOf(const std::string& unknown) {
  if (unknown == "absent") return map_request_t::UNKNOWN_ABSENT;
  if (unknown == "occupied") return map_request_t::UNKNOWN_OCCUPIED;
  return map_request_t::UNKNOWN_DEFAULT;
}

}  // namespace

Result<map_request_t> SpaceRequest(const MapToolArguments& arguments, const std::string& verb) {
  map_request_t request{};
  request.verb = verb;
  request.unknown = PolicyOf(arguments.unknown);
  request.resolution_m = arguments.resolution_m;
  request.inflate_m = arguments.inflate_m;
  request.without = arguments.without;
  if (!arguments.region) return request;
  ObjectQuery query;
  if (const Result<void> set = SetRegion(*arguments.region, &query); !set)
    return tl::unexpected(set.error());
  request.has_bbx = true;
  std::copy_n(query.region_W->min().data(), 3, request.bbx_min_W);
  std::copy_n(query.region_W->max().data(), 3, request.bbx_max_W);
  return request;
}

tl::expected<std::optional<OccupancyDelta>, ExitFailure> EditsOf(const MapToolArguments& arguments,
                                                                 const LoadedMap& loaded) {
  if (arguments.without.empty()) return std::optional<OccupancyDelta>();
  Result<EditedSpace> space =
      EditSpace(loaded.map, loaded.metadata, arguments.without, arguments.config);
  if (!space) return ExitWith(ExitCode::kUsage, arguments.map + ": " + space.error().message);
  return std::optional(std::move(space->delta));
}

tl::expected<OccupancyMap, ExitFailure> SpaceOf(const MapToolArguments& arguments,
                                                const LoadedMap& loaded) {
  const auto edits = EditsOf(arguments, loaded);
  if (!edits) return tl::unexpected(edits.error());
  OccupancyMap space = ClassifyNearParts(loaded.map, loaded.metadata, arguments.config.free_space);
  if (*edits) LayOver(**edits, std::nullopt, &space);
  return space;
}

}  // namespace vismap
