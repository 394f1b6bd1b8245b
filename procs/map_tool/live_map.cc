#include "map_tool/live_map.h"

#include <unistd.h>

#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "base/json_text.h"

namespace vismap {

tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         map_request_t request) {
  // The pid in the name makes it unique, so that each caller gets its own answer.
  const std::string verb = request.verb;
  const auto bus = OpenBus(context.options, context.options.name + "-" + std::to_string(getpid()),
                           &context.stop);
  if (!bus) return ExitWith(ExitCode::kFailed, bus.error().message);
  Result<map_reply_t> reply = SendRequest(**bus, std::move(request), arguments.timeout);
  if (!reply) return ExitWith(ExitCode::kFailed, reply.error().message);
  if (reply->encoding == "json" && !ParseJson(PayloadText(*reply)))
    return ExitWith(ExitCode::kFailed, "the answer to the request '" + verb + "' is not JSON");
  return std::move(*reply);
}

tl::expected<map_reply_t, ExitFailure> RequestFromServer(const MapToolArguments& arguments,
                                                         ProcessContext& context,
                                                         const std::string& verb,
                                                         const std::string& path,
                                                         const std::string& argument) {
  map_request_t request{};
  request.verb = verb;
  request.path = path;
  request.argument = argument;
  return RequestFromServer(arguments, context, std::move(request));
}

tl::expected<LoadedMap, ExitFailure> LoadSavedMap(const MapToolArguments& arguments) {
  Result<LoadedMap> loaded = LoadMap(arguments.map, MaxMapBytes(arguments.config.integration));
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  return std::move(*loaded);
}

tl::expected<LoadedMap, ExitFailure> LoadMapOrLive(const MapToolArguments& arguments,
                                                   ProcessContext& context) {
  if (arguments.map != kLive) return LoadSavedMap(arguments);
  const auto reply = RequestFromServer(arguments, context, "map");
  if (!reply) return tl::unexpected(reply.error());
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(reply->payload.data()),
                                       reply->payload.size());
  Result<LoadedMap> loaded =
      DecodeMap(bytes, "map of the running server", MaxMapBytes(arguments.config.integration));
  if (!loaded) return ExitWith(ExitCode::kFailed, loaded.error().message);
  return std::move(*loaded);
}

std::string PayloadText(const map_reply_t& reply) {
  return {reply.payload.begin(), reply.payload.end()};
}

}  // namespace vismap
