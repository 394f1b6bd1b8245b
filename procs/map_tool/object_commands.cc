#include <cstdio>
#include <filesystem>
#include <utility>

#include "base/class_names.h"
#include "base/file.h"
#include "exports/objects_json.h"
#include "exports/outputs.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/object_table.h"
#include "objects/object_query.h"

// The subcommands `objects` and `export` of vismap-map.

namespace vismap {
namespace {

namespace fs = std::filesystem;

Result<ObjectQuery> QueryOf(const MapToolArguments& arguments) {
  ObjectQuery query;
  for (const auto& [text, set] :
       {std::pair{&arguments.id, &SetId}, std::pair{&arguments.class_name, &SetClassOf},
        std::pair{&arguments.region, &SetRegion}}) {
    if (!*text) continue;
    if (const Result<void> done = set(**text, &query); !done) return tl::unexpected(done.error());
  }
  return query;
}

/// A saved map with its mesh and with the selected objects only.
struct SelectedObjects {
  LoadedMap loaded;
  MapProducts products;
};

tl::expected<SelectedObjects, ExitFailure> Select(const MapToolArguments& arguments,
                                                  const ObjectQuery& query) {
  Result<LoadedMap> loaded = LoadMap(arguments.map, MaxMapBytes(arguments.config.integration));
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  MapProducts products = MakeProducts(loaded->map, loaded->metadata, arguments.config);
  Result<std::vector<ObjectSummary>> objects = SelectObjects(products.objects, query);
  if (!objects) return ExitWith(ExitCode::kFailed, arguments.map + ": " + objects.error().message);
  products.objects = std::move(*objects);
  return SelectedObjects{std::move(*loaded), std::move(products)};
}

tl::expected<std::string, ExitFailure> ObjectsTextOf(const MapToolArguments& arguments,
                                                     const ObjectQuery& query,
                                                     ProcessContext& context) {
  if (arguments.map == kLive) {
    const auto reply = RequestFromServer(arguments, context, "objects", "", ToText(query));
    if (!reply) return tl::unexpected(reply.error());
    return PayloadText(*reply);
  }
  const auto selected = Select(arguments, query);
  if (!selected) return tl::unexpected(selected.error());
  return ObjectsText(selected->loaded.metadata, selected->products);
}

/// Writes meshes and points of the selected objects.
Outcome ExportObjects(const MapToolArguments& arguments, const ObjectQuery& query) {
  const auto selected = Select(arguments, query);
  if (!selected) return tl::unexpected(selected.error());
  const auto files =
      WriteSelectedObjects(selected->loaded.metadata, selected->products, arguments.out);
  if (!files) return ExitWith(ExitCode::kFailed, files.error().message);
  if (files->empty()) {
    return ExitWith(ExitCode::kFailed,
                    arguments.map + ": none of the selected objects has a surface in the map");
  }
  for (const fs::path& file : *files) std::printf("%s\n", fs::absolute(file).c_str());
  return {};
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

Outcome RunExport(const MapToolArguments& arguments, ProcessContext&) {
  const Result<ObjectQuery> query = QueryOf(arguments);
  if (!query) return ExitWith(ExitCode::kUsage, query.error().message);
  if (!query->all()) return ExportObjects(arguments, *query);
  const auto all = Select(arguments, *query);
  if (!all) return tl::unexpected(all.error());
  const LoadedMap& loaded = all->loaded;
  const auto written =
      WriteOutputs(loaded.map, loaded.metadata, all->products, arguments.config, arguments.out);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  PrintObjects(ObjectsText(loaded.metadata, all->products), false);
  std::printf("map hash %s\nresults in %s\n", loaded.map_hash.c_str(),
              fs::absolute(arguments.out).c_str());
  return {};
}

}  // namespace vismap
