#include <cstdio>
#include <utility>

#include "exports/outputs.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/object_table.h"
#include "map_tool/selected_objects.h"

// The subcommand `objects` of vismap-map.

namespace vismap {
namespace {

tl::expected<std::string, ExitFailure> ObjectsTextOf(const MapToolArguments& arguments,
                                                     const ObjectQuery& query,
                                                     ProcessContext& context) {
  if (arguments.map == kLive) {
    const auto reply = RequestFromServer(arguments, context, "objects", "", ToText(query));
    if (!reply) return tl::unexpected(reply.error());
    return PayloadText(*reply);
  }
  const auto loaded = LoadMapOrLive(arguments, context);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto products = SelectProducts(arguments, *loaded, query);
  if (!products) return tl::unexpected(products.error());
  return ObjectsText(loaded->metadata, *products);
}

}  // namespace

Outcome RunObjects(const MapToolArguments& arguments, ProcessContext& context) {
  const Result<ObjectQuery> query = QueryOf(arguments);
  if (!query) return ExitWith(ExitCode::kUsage, query.error().message);
  const auto text = ObjectsTextOf(arguments, *query, context);
  if (!text) return tl::unexpected(text.error());
  if (arguments.json) {
    std::printf("%s\n", text->c_str());
  } else {
    PrintObjects(*text, !query->all());
  }
  return {};
}

}  // namespace vismap
