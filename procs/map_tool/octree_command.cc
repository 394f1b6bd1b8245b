#include <cstdio>
#include <filesystem>

#include "base/file.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/space_request.h"
#include "requests/octree_request.h"

// The subcommand `octree` of vismap-map.

namespace vismap {
namespace {

Result<map_request_t> OctreeRequestOf(const MapToolArguments& arguments) {
  Result<map_request_t> request =
      SpaceRequest(arguments, arguments.from_exporter ? "octomap" : "octree");
  if (request && arguments.color) request->tree = map_request_t::TREE_COLOR;
  return request;
}

tl::expected<Answer, ExitFailure> OctreeOfFile(const MapToolArguments& arguments,
                                               const map_request_t& request) {
  const auto loaded = LoadSavedMap(arguments);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto edits = EditsOf(arguments, *loaded);
  if (!edits) return tl::unexpected(edits.error());
  Result<Answer> answer = AnswerMapOctree(loaded->map, loaded->metadata, request, arguments.config,
                                          *edits ? &**edits : nullptr);
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
