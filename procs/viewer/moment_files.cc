#include "viewer/moment_files.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/printable.h"
#include "exports/ply.h"
#include "objects/object_mesh.h"
#include "objects/object_query.h"
#include "requests/navigation_answers.h"
#include "requests/octree_request.h"

namespace vismap {

std::optional<std::string> ObjectOfPath(const std::string& path) {
  constexpr std::string_view kObject = "/api/object/", kPly = ".ply";
  if (!path.starts_with(kObject) || !path.ends_with(kPly)) return std::nullopt;
  if (path.size() <= kObject.size() + kPly.size()) return std::nullopt;
  return path.substr(kObject.size(), path.size() - kObject.size() - kPly.size());
}

bool IsObjectName(const std::string& name) {
  const std::string digits = name.starts_with('s') ? name.substr(1) : name;
  return !digits.empty() && digits.size() <= 10 &&
         std::all_of(digits.begin(), digits.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

HttpAnswer WrongObjectName(const std::string& name) {
  return ErrorAnswer(400,
                     "an object is named by its instance, such as 7, or by a segment, such as s12; "
                     "found '" +
                         PrintableText(name, 60) + "'");
}

HttpAnswer ObjectFiles::Ply(const std::shared_ptr<const LoadedMap>& map, const std::string& name,
                            const OutputOptions& options) {
  if (map_ != map) {
    MapProducts products = MakeProducts(map->map, map->metadata, options);
    objects_ = std::move(products.objects);
    surfaces_ = CutObjects(products.mesh, objects_);
    map_ = map;
  }
  const Result<ObjectQuery> query = ParseObjectQuery("id=" + name);
  if (!query) return ErrorAnswer(400, query.error().message);
  const auto selected = SelectObjects(objects_, *query);
  if (!selected) return ErrorAnswer(400, selected.error().message);
  const auto object =
      std::find_if(objects_.begin(), objects_.end(), [&](const ObjectSummary& other) {
        return other.instance == selected->front().instance &&
               other.segments == selected->front().segments;
      });
  const Mesh& surface = surfaces_.at(static_cast<size_t>(object - objects_.begin()));
  if (surface.vertices.empty())
    return ErrorAnswer(400, "the object " + name + " has no surface in the map");
  return {200, "application/octet-stream", EncodePly(surface, {map->metadata.map_id, {}}),
          "object-" + name + ".ply"};
}

HttpAnswer TreeOf(const OccupancyMap& space, const LeafQuestion& question, int64_t utime,
                  const OctreeOptions& options) {
  const Result<OctreeRequest> request =
      ReadOctreeRequest(TreeRequest(question), space.cell_size(), options);
  if (!request) return ErrorAnswer(400, request.error().message);
  Result<Answer> tree = AnswerOctree(space, *request, utime);
  if (!tree) return ErrorAnswer(400, tree.error().message);
  return {200, "application/octet-stream", std::move(tree->payload), ""};
}

Result<SliceDistances> DistancesIn(const OccupancyMap& space, const Slice& slice,
                                   const SliceQuestion& question, const OctreeOptions& options) {
  NavigationSpace navigation;
  navigation.voxels = &space;
  navigation.octree = options;
  const Result<Answer> answer = AnswerDistances(navigation, DistanceRequest(slice, question));
  if (!answer) return tl::unexpected(answer.error());
  return ReadDistances(answer->payload, slice, question);
}

}  // namespace vismap
