#include "map_tool/selected_objects.h"

#include <utility>

namespace vismap {

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

tl::expected<MapProducts, ExitFailure> SelectProducts(const MapToolArguments& arguments,
                                                      const LoadedMap& loaded,
                                                      const ObjectQuery& query) {
  MapProducts products = MakeProducts(loaded.map, loaded.metadata, arguments.config);
  Result<std::vector<ObjectSummary>> objects = SelectObjects(products.objects, query);
  if (!objects) return ExitWith(ExitCode::kFailed, arguments.map + ": " + objects.error().message);
  products.objects = std::move(*objects);
  return products;
}

}  // namespace vismap
