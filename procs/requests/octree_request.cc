#include "requests/octree_request.h"

#include <cmath>
#include <utility>

#include "base/printable.h"
#include "base/require.h"
#include "exports/color_octree.h"
#include "freespace/octree_builder.h"
#include "freespace/shortest_text.h"
#include "navigation/inflate.h"
#include "navigation/overlay.h"

namespace vismap {
namespace {

constexpr size_t kMostText = 60;  // of a text that is repeated in an error

Result<UnknownPolicy> PolicyOf(const map_request_t& request) {
  switch (request.unknown) {
    case map_request_t::UNKNOWN_DEFAULT:
      return request.tree == map_request_t::TREE_COLOR ? UnknownPolicy::kAbsent
                                                       : UnknownPolicy::kOccupied;
    case map_request_t::UNKNOWN_OCCUPIED:
      return UnknownPolicy::kOccupied;
    case map_request_t::UNKNOWN_ABSENT:
      return UnknownPolicy::kAbsent;
    default:
      return Fail("unknown: expected -1 (closed), 0 (raw) or 1 (closed), found " +
                  std::to_string(request.unknown));
  }
}

Result<bool> ColorOf(const map_request_t& request) {
  if (request.tree == map_request_t::TREE_OCCUPANCY) return false;
  if (request.tree == map_request_t::TREE_COLOR) return true;
  return Fail("tree: expected 0 (OcTree) or 1 (ColorOcTree), found " +
              std::to_string(request.tree));
}

Result<double> ResolutionOf(const map_request_t& request, double voxel_size, double usual) {
  const double wanted = request.resolution_m;
  if (!std::isfinite(wanted) || wanted < 0) {
    return Fail("resolution_m: expected 0, or 2 to 64 times the voxel size of " +
                ShortestText(voxel_size) + " m, found " + ShortestText(wanted));
  }
  const Result<OctreeGrid> grid = ChooseOctreeGrid(voxel_size, wanted == 0 ? usual : wanted);
  if (!grid) return tl::unexpected(grid.error());
  return grid->resolution;
}

Result<double> InflationOf(const map_request_t& request, UnknownPolicy unknown, double leaf) {
  const double radius = request.inflate_m, most = kMostInflatedLeaves * leaf;
  if (!(radius >= 0 && radius <= most)) {
    return Fail("inflate_m: expected a radius from 0 to " + ShortestText(kMostInflatedLeaves) +
                " leaves of " + ShortestText(leaf) + " m, found " + ShortestText(radius) + " m");
  }
  if (radius > 0 && unknown == UnknownPolicy::kAbsent)
    return Fail("inflate_m: only closed trees can be inflated, and unknown = 0 asks for a raw one");
  return radius;
}

Result<std::optional<Eigen::AlignedBox3d>> BoxOf(const map_request_t& request) {
  if (!request.has_bbx) return std::optional<Eigen::AlignedBox3d>();
  const Eigen::AlignedBox3d box{Eigen::Vector3d(request.bbx_min_W),
                                Eigen::Vector3d(request.bbx_max_W)};
  if (const Result<void> checked = CheckOctreeBounds(box); !checked)
    return tl::unexpected(checked.error());
  return std::optional(box);
}

Result<void> CheckTexts(const map_request_t& request) {
  if (!request.argument.empty()) {
    return Fail("argument: expected none, found '" + PrintableText(request.argument, kMostText) +
                "'; box, resolution, policy and radius are fields of map_request_t");
  }
  return {};
}

std::string Nothing(const OctreeRequest& request) {
  return request.tree.bounds_W ? "nothing is known in this box" : "nothing is known yet";
}

/// The closed tree of leaves that were inflated.
Result<OctreeBytes> BuildInflated(const OccupancyMap& leaves, const OctreeRequest& request) {
  const Result<OccupancyMap> inflated = Inflate(leaves, {.radius_m = request.inflate_m});
  if (!inflated) return tl::unexpected(inflated.error());
  OctreeCache cache;
  cache.Update(*inflated, inflated->SortedIndices());
  return cache.Encode(*inflated, request.tree);
}

}  // namespace

std::optional<BlockRegion> OctreeRequest::Region(double block_size) const {
  if (!tree.bounds_W) return std::nullopt;
  return RegionAround(*tree.bounds_W, inflate_m + 2 * tree.resolution_m, block_size);
}

Result<OctreeRequest> ReadOctreeRequest(const map_request_t& request, double voxel_size,
                                        const OctreeOptions& defaults) {
  OctreeRequest read;
  read.tree = defaults;
  const Result<void> texts = CheckTexts(request);
  if (!texts) return tl::unexpected(texts.error());
  const Result<UnknownPolicy> unknown = PolicyOf(request);
  if (!unknown) return tl::unexpected(unknown.error());
  const Result<bool> color = ColorOf(request);
  if (!color) return tl::unexpected(color.error());
  const auto resolution = ResolutionOf(request, voxel_size, defaults.resolution_m);
  if (!resolution) return tl::unexpected(resolution.error());
  const Result<double> inflation = InflationOf(request, *unknown, *resolution);
  if (!inflation) return tl::unexpected(inflation.error());
  const Result<std::optional<Eigen::AlignedBox3d>> box = BoxOf(request);
  if (!box) return tl::unexpected(box.error());
  read.tree.unknown = *unknown;
  read.color = *color;
  read.tree.resolution_m = *resolution;
  read.inflate_m = *inflation;
  if (*box) read.tree.bounds_W = *box;
  return read;
}

Result<double> ReadLeaf(const map_request_t& request, double voxel_size, double usual) {
  return ResolutionOf(request, voxel_size, usual);
}

Result<std::optional<Eigen::AlignedBox3d>> ReadBox(const map_request_t& request) {
  return BoxOf(request);
}

Answer DescribeOctree(const OctreeBytes& octree, const OctreeRequest& request, int64_t utime) {
  const bool closed = octree.unknown == UnknownPolicy::kOccupied;
  std::string message = std::to_string(octree.nodes) + " nodes, " + (closed ? "closed" : "raw") +
                        ", leaves of " + ShortestText(octree.resolution) + " m";
  if (!octree.left_out.empty()) message += "; " + octree.left_out;
  Answer answer{message};
  answer.octree = OctreeFacts{utime,          octree.bounds_W, octree.resolution,
                              octree.unknown, octree.shell_m,  request.inflate_m};
  return answer;
}

Result<Answer> AnswerOctree(const OccupancyMap& map, const OctreeRequest& request, int64_t utime) {
  if (request.color)
    return Fail("tree: this program does not know the classes of things, so it has no ColorOcTree");
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), request.tree);
  if (!builder) return tl::unexpected(builder.error());
  const std::optional<BlockRegion> region = request.Region(map.cell_size() * kBlockSide);
  builder->Update(map, region ? BlocksIn(map.blocks(), *region) : map.SortedIndices());
  const Result<OctreeBytes> raw = builder->Build(UnknownPolicy::kAbsent);
  if (!raw) return tl::unexpected(raw.error());
  const bool closed = request.tree.unknown == UnknownPolicy::kOccupied;
  if (raw->nodes == 0 && !(closed && request.tree.bounds_W)) {
    return Fail(Nothing(request) +
                ", so that the tree would be empty, which collision checkers take for free space");
  }
  Result<OctreeBytes> octree = request.inflate_m > 0 ? BuildInflated(builder->leaves(), request)
                               : closed              ? builder->Build(UnknownPolicy::kOccupied)
                                                     : raw;
  if (!octree) return tl::unexpected(octree.error());
  Answer answer = DescribeOctree(*octree, request, utime);
  if (raw->nodes == 0) answer.message += "; " + Nothing(request) + ", all of it is occupied";
  answer.encoding = "bt";
  answer.payload = std::move(octree->bytes);
  return answer;
}

Result<Answer> AnswerMapOctree(const SemanticMap& map, const MapMetadata& metadata,
                               const map_request_t& request, const OutputOptions& options,
                               const OccupancyDelta* edited) {
  Require(request.without.empty() || edited != nullptr, "the space without these objects is given");
  const auto read = ReadOctreeRequest(request, map.voxels.voxel_size(), options.octree);
  if (!read) return tl::unexpected(read.error());
  const std::optional<BlockRegion> region = read->Region(map.voxels.block_size());
  OccupancyMap space = ClassifyNearParts(map, metadata, options.free_space, region);
  if (edited != nullptr) LayOver(*edited, region, &space);
  OctreeRequest tree = *read;
  tree.color = false;
  Result<Answer> answer = AnswerOctree(space, tree, map.last_utime);
  if (!answer || !read->color) return answer;
  Result<std::vector<uint8_t>> colored = ColorOctree(answer->payload, map);
  if (!colored) return tl::unexpected(colored.error());
  answer->payload = std::move(*colored);
  answer->encoding = "ot";
  answer->message += "; a ColorOcTree is for looking, planners must not use it";
  return answer;
}

}  // namespace vismap
