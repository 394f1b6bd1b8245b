#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <span>
#include <vismap/map_request_t.hpp>

#include "base/file.h"
#include "exports/outputs.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "objects/object_query.h"
#include "requests/object_edits.h"
#include "requests/octree_request.h"

// The subcommand `octree` of vismap-map.

namespace vismap {
namespace {

Result<map_request_t> OctreeRequestOf(const MapToolArguments& arguments) {
  map_request_t request{};
  request.verb = arguments.from_exporter ? "octomap" : "octree";
  request.resolution_m = arguments.resolution_m;
  request.inflate_m = arguments.inflate_m;
  request.unknown = arguments.unknown.empty()       ? map_request_t::UNKNOWN_DEFAULT
                    : arguments.unknown == "absent" ? map_request_t::UNKNOWN_ABSENT
                                                    : map_request_t::UNKNOWN_OCCUPIED;
  request.without = arguments.without;
  request.tree = arguments.color ? map_request_t::TREE_COLOR : map_request_t::TREE_OCCUPANCY;
  if (!arguments.region) return request;
  ObjectQuery query;
  if (const Result<void> set = SetRegion(*arguments.region, &query); !set)
    return tl::unexpected(set.error());
  request.has_bbx = true;
  std::copy_n(query.region_W->min().data(), 3, request.bbx_min_W);
  std::copy_n(query.region_W->max().data(), 3, request.bbx_max_W);
  return request;
}

tl::expected<Answer, ExitFailure> OctreeOfFile(const MapToolArguments& arguments,
                                               const map_request_t& request) {
  const Result<LoadedMap> loaded =
      LoadMap(arguments.map, MaxMapBytes(arguments.config.integration));
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  const OutputOptions options = arguments.config;
  EditedSpace edited;
  if (!request.without.empty()) {
    Result<EditedSpace> space = EditSpace(loaded->map, loaded->metadata, request.without, options);
    if (!space) return ExitWith(ExitCode::kUsage, arguments.map + ": " + space.error().message);
    edited = std::move(*space);
  }
  Result<Answer> answer =
      AnswerMapOctree(loaded->map, loaded->metadata, request, options, &edited.delta);
  if (!answer) return ExitWith(ExitCode::kUsage, arguments.map + ": " + answer.error().message);
  return std::move(*answer);
}

}  // namespace

Outcome RunOctree(const MapToolArguments& arguments, ProcessContext& context) {
  const Result<map_request_t> request = OctreeRequestOf(arguments);
  if (!request) return ExitWith(ExitCode::kUsage, request.error().message);
  std::string message;
  std::vector<uint8_t> bytes;
  if (arguments.map == kLive) {
    const auto reply = RequestFromServer(arguments, context, *request);
    if (!reply) return tl::unexpected(reply.error());
    message = reply->message;
    bytes.assign(reply->payload.begin(), reply->payload.end());
  } else {
    auto answer = OctreeOfFile(arguments, *request);
    if (!answer) return tl::unexpected(answer.error());
    message = answer->message;
    bytes = std::move(answer->payload);
  }
  if (const Result<void> written = WriteFileAtomically(arguments.out, bytes); !written)
    return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("wrote %s: %s\n", std::filesystem::absolute(arguments.out).c_str(), message.c_str());
  return {};
}

}  // namespace vismap
