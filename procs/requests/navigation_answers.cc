#include "requests/navigation_answers.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/enum_names.h"
#include "base/format.h"
#include "base/printable.h"
#include "freespace/block_region.h"
#include "freespace/octree_builder.h"
#include "freespace/shortest_text.h"
#include "navigation/frontiers.h"
#include "navigation/inflate.h"
#include "requests/octree_request.h"
#include "requests/request_argument.h"
#include "runtime/clock.h"
#include "wire/distance_update.h"
#include "wire/envelope.h"
#include "wire/grid_message.h"

namespace vismap {
namespace {

using Box = std::optional<Eigen::AlignedBox3d>;
using Json = nlohmann::ordered_json;

constexpr size_t kMostWords = 60;  // of a text that is repeated in an error

/// What all requests state alike.
struct Question {
  Box box_W;
  double leaf_m = 0;
  RequestArgument argument;
};

Result<void> CheckUnused(const map_request_t& request, bool may_inflate, bool is_edited) {
  if (request.tree != map_request_t::TREE_OCCUPANCY)
    return Fail("tree: expected 0, found " + std::to_string(request.tree));
  if (request.unknown < map_request_t::UNKNOWN_DEFAULT ||
      request.unknown > map_request_t::UNKNOWN_OCCUPIED)
    return Fail("unknown: expected -1, 0 or 1, found " + std::to_string(request.unknown));
  if (!may_inflate && request.inflate_m != 0) {
    return Fail("inflate_m: expected 0 with this verb, found " + ShortestText(request.inflate_m) +
                " m");
  }
  if (!request.without.empty() && !is_edited) {
    return Fail("without: this program cannot leave objects out here, found '" +
                PrintableText(request.without, kMostWords) + "'");
  }
  return {};
}

Result<Question> ReadQuestion(const NavigationSpace& space, const map_request_t& request,
                              const std::vector<std::string>& keys, double usual_leaf,
                              bool may_inflate = false) {
  if (const Result<void> checked = CheckUnused(request, may_inflate, space.is_edited); !checked)
    return tl::unexpected(checked.error());
  Result<Box> box = ReadBox(request);
  if (!box) return tl::unexpected(box.error());
  const Result<double> leaf = ReadLeaf(request, space.voxels->cell_size(), usual_leaf);
  if (!leaf) return tl::unexpected(leaf.error());
  Result<RequestArgument> argument = RequestArgument::Read(request.argument, keys);
  if (!argument) return tl::unexpected(argument.error());
  return Question{std::move(*box), *leaf, std::move(*argument)};
}

/// The blocks within `margin` of a box, or all.
std::vector<BlockIndex> BlocksAround(const OccupancyMap& map, const Box& box_W, double margin) {
  if (!box_W) return map.SortedIndices();
  return BlocksIn(map.blocks(), RegionAround(*box_W, margin, map.cell_size() * kBlockSide));
}

OccupancyMap CopyOf(const OccupancyMap& map, const Box& box_W, double margin) {
  OccupancyMap copy(map.cell_size());
  for (const BlockIndex& index : BlocksAround(map, box_W, margin)) copy.Set(index, map.At(index));
  return copy;
}

bool HasLeaves(const NavigationSpace& space, double leaf_m) {
  return space.leaves != nullptr && std::abs(space.leaves->cell_size() - leaf_m) < 1e-9;
}

/// The leaves within `margin` of a box, or all.
Result<OccupancyMap> LeavesAround(const NavigationSpace& space, double leaf_m, const Box& box_W,
                                  double margin) {
  if (HasLeaves(space, leaf_m)) return CopyOf(*space.leaves, box_W, margin);
  OctreeOptions options = space.octree;
  options.resolution_m = leaf_m;
  Result<OctreeBuilder> builder = OctreeBuilder::Make(space.voxels->cell_size(), options);
  if (!builder) return tl::unexpected(builder.error());
  builder->Update(*space.voxels, BlocksAround(*space.voxels, box_W, margin + leaf_m));
  return CopyOf(builder->leaves(), {}, 0);
}

std::vector<uint8_t> TextBytes(const Json& json) {
  const std::string text = json.dump();
  return {text.begin(), text.end()};
}

Json JsonOf(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Json HeadOf(const NavigationSpace& space, double leaf_m) {
  return {{"map_id", space.map_id},
          {"revision", space.revision},
          {"utime", space.utime},
          {"resolution_m", leaf_m}};
}

Result<GroundGridOptions> GridOptionsOf(const NavigationSpace& space, const Question& question) {
  GroundGridOptions options = space.grid;
  options.resolution_m = question.leaf_m;
  const std::pair<const char*, double*> numbers[] = {{"height", &options.robot_height_m},
                                                     {"step", &options.step_height_m},
                                                     {"slope", &options.max_slope_deg},
                                                     {"limit", &options.distance_limit_m}};
  for (const auto& [key, member] : numbers) {
    const Result<double> number = question.argument.Number(key, *member);
    if (!number) return tl::unexpected(number.error());
    *member = *number;
  }
  if (question.argument.Has("band")) {
    const Result<std::vector<double>> band = question.argument.Numbers("band", 2);
    if (!band) return tl::unexpected(band.error());
    if ((*band)[0] >= (*band)[1]) {
      return Fail("band: expected the lower height first, found '" +
                  PrintableText(question.argument.Text("band"), kMostWords) + "'");
    }
    options.band_min_m = (*band)[0];
    options.band_max_m = (*band)[1];
  }
  return options;
}

/// A field to read from, and the leaves that it is made of.
class FieldAtHand {
 public:
  static Result<FieldAtHand> Find(const NavigationSpace& space, const Question& question,
                                  const Eigen::AlignedBox3d& box_W);
  const DistanceField& field() const { return made_ ? *made_ : *kept_; }
  const OccupancyMap& leaves() const { return made_ ? *leaves_ : *kept_leaves_; }

 private:
  const DistanceField* kept_ = nullptr;
  const OccupancyMap* kept_leaves_ = nullptr;
  std::optional<DistanceField> made_;
  std::optional<OccupancyMap> leaves_;
};

Result<FieldAtHand> FieldAtHand::Find(const NavigationSpace& space, const Question& question,
                                      const Eigen::AlignedBox3d& box_W) {
  FieldAtHand found;
  const bool has_field = space.field != nullptr && HasLeaves(space, question.leaf_m);
  const Result<double> limit = question.argument.Number("limit", space.distance_limit_m);
  if (!limit) return tl::unexpected(limit.error());
  if (has_field && space.field->limit_m() == *limit) {
    found.kept_ = space.field;
    found.kept_leaves_ = space.leaves;
    return found;
  }
  const double most = kMostDistanceLeaves * question.leaf_m;
  if (!(*limit > 0 && *limit <= most)) {
    return Fail("limit: expected more than 0 and at most " + ShortestText(kMostDistanceLeaves) +
                " leaves of " + ShortestText(question.leaf_m) + " m, found " +
                ShortestText(*limit) + " m");
  }
  const double margin = *limit + 2 * question.leaf_m;
  Result<OccupancyMap> leaves = LeavesAround(space, question.leaf_m, box_W, margin);
  if (!leaves) return tl::unexpected(leaves.error());
  Result<DistanceField> field = DistanceField::Make(leaves->cell_size(), {*limit});
  if (!field) return tl::unexpected(field.error());
  found.leaves_.emplace(std::move(*leaves));
  field->Update(*found.leaves_, found.leaves_->SortedIndices());
  found.made_.emplace(std::move(*field));
  return found;
}

Result<std::vector<Eigen::Vector3d>> PointsOf(const RequestArgument& argument) {
  if (argument.Text("at").empty())
    return Fail("at: expected points at=x,y,z;x,y,z [m], found none");
  std::vector<Eigen::Vector3d> points;
  std::istringstream stream(argument.Text("at"));
  for (std::string text; std::getline(stream, text, ';');) {
    const Result<std::vector<double>> p = ReadNumbersOf("at", text, 3);
    if (!p) return tl::unexpected(p.error());
    points.emplace_back((*p)[0], (*p)[1], (*p)[2]);
  }
  return points;
}

Json JsonOf(const Eigen::Vector3d& p_W, const DistanceField& field) {
  const Clearance nearest = field.From(p_W);
  return {{"at", JsonOf(p_W)},
          {"distance_m", nearest.distance_m},
          {"gradient", JsonOf(nearest.away_W)},
          {"nearest", NameOf(nearest.nearest)},
          {"obstacle_m", field.FromObstacle(p_W).distance_m},
          {"unknown_m", field.FromUnknown(p_W).distance_m}};
}

Json JsonOf(const Frontier& frontier) {
  return {{"leaves", frontier.leaves.size()},
          {"center_W", JsonOf(frontier.center_W)},
          {"member_W", JsonOf(frontier.member_W)},
          {"viewpoint_W", frontier.viewpoint_W ? JsonOf(*frontier.viewpoint_W) : Json(nullptr)}};
}

Result<FrontierOptions> FrontierOptionsOf(const Question& question) {
  FrontierOptions options;
  const auto cluster = question.argument.Number("cluster", options.cluster_m);
  if (!cluster) return tl::unexpected(cluster.error());
  const auto least = question.argument.Number("least", options.min_leaves);
  if (!least) return tl::unexpected(least.error());
  if (*least != std::floor(*least) || *least < 1 || *least > 1e6)
    return Fail("least: expected a whole number from 1 to 1000000, found " + ShortestText(*least));
  options.cluster_m = *cluster;
  options.min_leaves = static_cast<int>(*least);
  return options;
}

}  // namespace

Result<Answer> AnswerGrid(const NavigationSpace& space, const map_request_t& request) {
  const Result<Question> question = ReadQuestion(
      space, request, {"height", "step", "slope", "band", "limit"}, space.grid.resolution_m);
  if (!question) return tl::unexpected(question.error());
  const Result<GroundGridOptions> options = GridOptionsOf(space, *question);
  if (!options) return tl::unexpected(options.error());
  std::optional<OccupancyMap> part;
  if (question->box_W) part.emplace(CopyOf(*space.voxels, question->box_W, 0));
  Result<GroundGrid> grid = MakeGroundGrid(part ? *part : *space.voxels, *options, space.path_W);
  if (!grid) return tl::unexpected(grid.error());
  if (grid->states.empty()) return Fail("grid: nothing is known in this space yet");
  std::string message = "grid of " + std::to_string(grid->width) + " x " +
                        std::to_string(grid->height) + " cells of " +
                        ShortestText(grid->resolution_m) + " m";
  GridMessage content{space.utime,    WallUtime(), space.map_id,
                      space.revision, *options,    std::move(*grid)};
  occupancy_grid_t encoded = Encode(content);
  return Answer{std::move(message), "occupancy_grid_t", Pack(encoded)};
}

Result<Answer> AnswerDistances(const NavigationSpace& space, const map_request_t& request) {
  const Result<Question> question =
      ReadQuestion(space, request, {"limit"}, space.octree.resolution_m);
  if (!question) return tl::unexpected(question.error());
  if (!question->box_W) return Fail("has_bbx: expected true, since distances need a box");
  const Result<FieldAtHand> found = FieldAtHand::Find(space, *question, *question->box_W);
  if (!found) return tl::unexpected(found.error());
  const BlockRegion region =
      RegionAround(*question->box_W, 0, found->leaves().cell_size() * kBlockSide);
  const std::vector<BlockIndex> blocks = BlocksIn(found->leaves().blocks(), region);
  if (blocks.size() > static_cast<size_t>(kMaxDistanceBlocks)) {
    return Fail("box: it has " + std::to_string(blocks.size()) +
                " blocks of 8 x 8 x 8 leaves, expected at most " +
                std::to_string(kMaxDistanceBlocks) + "; ask for a smaller box or larger leaves");
  }
  DistanceUpdate update;
  update.head = {space.map_id, space.revision, -1, true, 0, 1};
  update.utime = space.utime;
  update.published_utime = WallUtime();
  update.leaf_m = question->leaf_m;
  update.limit_m = found->field().limit_m();
  for (const BlockIndex& index : blocks)
    update.blocks.emplace_back(index, found->field().At(index));
  distance_field_t message = Encode(update);
  return Answer{std::to_string(blocks.size()) + " blocks of 8 x 8 x 8 leaves of " +
                    ShortestText(question->leaf_m) + " m" +
                    (blocks.empty() ? "; nothing is known in this box" : ""),
                "distance_field_t", Pack(message)};
}

Result<Answer> AnswerClearance(const NavigationSpace& space, const map_request_t& request) {
  const Result<Question> question =
      ReadQuestion(space, request, {"at", "limit"}, space.octree.resolution_m);
  if (!question) return tl::unexpected(question.error());
  if (question->box_W) return Fail("has_bbx: expected false, since the points are in at=x,y,z");
  const auto points = PointsOf(question->argument);
  if (!points) return tl::unexpected(points.error());
  Eigen::AlignedBox3d box_W;
  for (const Eigen::Vector3d& p : *points) box_W.extend(p);
  const Result<FieldAtHand> found = FieldAtHand::Find(space, *question, box_W);
  if (!found) return tl::unexpected(found.error());
  Json json = HeadOf(space, question->leaf_m);
  json["limit_m"] = found->field().limit_m();
  json["points"] = Json::array();
  for (const Eigen::Vector3d& p : *points) json["points"].push_back(JsonOf(p, found->field()));
  return Answer{FormatCount(static_cast<int64_t>(points->size()), "point"), "json",
                TextBytes(json)};
}

Result<Answer> AnswerFrontiers(const NavigationSpace& space, const map_request_t& request) {
  const Result<Question> question =
      ReadQuestion(space, request, {"cluster", "least"}, space.octree.resolution_m, true);
  if (!question) return tl::unexpected(question.error());
  const Result<FrontierOptions> options = FrontierOptionsOf(*question);
  if (!options) return tl::unexpected(options.error());
  const double most = kMostInflatedLeaves * question->leaf_m;
  if (!(request.inflate_m >= 0 && request.inflate_m <= most)) {
    return Fail("inflate_m: expected a radius from 0 to " + ShortestText(most) + " m, found " +
                ShortestText(request.inflate_m) + " m");
  }
  const double radius = request.inflate_m > 0 ? request.inflate_m : space.robot_radius_m;
  const double margin = options->cluster_m + options->max_view_m + radius + 2 * question->leaf_m;
  const auto leaves = LeavesAround(space, question->leaf_m, question->box_W, margin);
  if (!leaves) return tl::unexpected(leaves.error());
  const auto inflated = Inflate(*leaves, {.radius_m = radius});
  if (!inflated) return tl::unexpected(inflated.error());
  const auto frontiers = FindFrontiers(*leaves, *inflated, *options);
  if (!frontiers) return tl::unexpected(frontiers.error());
  Json json = HeadOf(space, question->leaf_m);
  json["robot_radius_m"] = radius;
  json["frontiers"] = Json::array();
  for (const Frontier& frontier : *frontiers) {
    if (!question->box_W || question->box_W->contains(frontier.center_W))
      json["frontiers"].push_back(JsonOf(frontier));
  }
  return Answer{FormatCount(static_cast<int64_t>(json["frontiers"].size()), "frontier"), "json",
                TextBytes(json)};
}

}  // namespace vismap
