#include "viewer/leaves.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/printable.h"
#include "freespace/octree.h"
#include "freespace/octree_cube.h"
#include "requests/request_argument.h"

namespace vismap {
namespace {

constexpr std::array<const char*, 3> kLeafAxes = {"x", "y", "z"};
constexpr double kMostMetres = 1e5, kMostRadius = 10;

/// Reads nodes that CheckOctree has checked, and keeps the leaves of one layer.
class LeafCutter {
 public:
  LeafCutter(std::span<const uint8_t> nodes, int axis, double layer, double leaf_m)
      : nodes_(nodes), axis_(static_cast<size_t>(axis)), layer_(layer), leaf_m_(leaf_m) {}

  void Visit(const OctreeCube& cube) {
    const uint32_t code = nodes_[at_] | static_cast<uint32_t>(nodes_[at_ + 1]) << 8;
    at_ += 2;
    for (int child = 0; child < 8; ++child) {
      const uint32_t kind = (code >> (2 * child)) & 3;
      if (kind == 3) {
        Visit(cube.Child(child));
      } else if (kind != 0) {
        Add(cube.Child(child), kind == 2);
      }
    }
  }
  std::vector<TreeLeaf> leaves;

 private:
  void Add(const OctreeCube& cube, bool occupied) {
    const std::array<int32_t, 3> min{cube.min.x, cube.min.y, cube.min.z};
    if (layer_ < min[axis_] || layer_ >= min[axis_] + cube.size) return;
    TreeLeaf leaf{{}, cube.size * leaf_m_, occupied};
    for (size_t i = 0; i < 3; ++i) leaf.center_W[i] = (min[i] + 0.5 * cube.size) * leaf_m_;
    leaves.push_back(leaf);
  }

  std::span<const uint8_t> nodes_;
  size_t axis_;
  double layer_, leaf_m_;  // layer: number of the smallest leaves on the axis
  size_t at_ = 0;
};

Result<void> ReadLayer(const std::string& value, bool* inflated, LeafQuestion* question) {
  *inflated = value == "inflated";
  question->closed = *inflated || value == "closed";
  if (question->closed || value == "raw") return {};
  return Fail("layer: expected raw, closed or inflated, found '" + PrintableText(value, 60) + "'");
}

}  // namespace

Result<LeafQuestion> ReadLeafQuestion(const HttpTarget& target) {
  LeafQuestion question;
  bool inflated = false;
  for (const auto& [key, value] : target.query) {
    if (key == "axis") {
      const auto found = std::find(kLeafAxes.begin(), kLeafAxes.end(), value);
      if (found == kLeafAxes.end())
        return Fail("axis: expected x, y or z, found '" + PrintableText(value, 60) + "'");
      question.axis = static_cast<int>(found - kLeafAxes.begin());
    } else if (key == "layer") {
      if (Result<void> read = ReadLayer(value, &inflated, &question); !read)
        return tl::unexpected(read.error());
    } else if (key == "at" || key == "radius") {
      const auto number = ReadNumbersOf(key, value, 1);
      if (!number) return tl::unexpected(number.error());
      (key == "at" ? question.at_m : question.inflate_m) = number->front();
    } else {
      return Fail("leaves: the arguments are axis, at, layer and radius, found '" +
                  PrintableText(key, 60) + "'");
    }
  }
  if (!target.query.contains("at")) return Fail("leaves: say where with at=METRES");
  if (std::abs(question.at_m) > kMostMetres) return Fail("at: expected at most 100000 m");
  if (target.query.contains("radius") != inflated)
    return Fail("radius: layer=inflated needs it, and no other layer has it");
  if (inflated && !(question.inflate_m > 0 && question.inflate_m <= kMostRadius))
    return Fail("radius: expected more than 0 and at most 10 m");
  return question;
}

map_request_t TreeRequest(const LeafQuestion& question) {
  map_request_t request{};  // also sets its numbers to 0
  request.verb = "octomap";
  request.unknown =
      question.closed ? map_request_t::UNKNOWN_OCCUPIED : map_request_t::UNKNOWN_ABSENT;
  request.inflate_m = question.inflate_m;
  return request;
}

Result<LeafCut> CutLeaves(std::span<const uint8_t> tree, int axis, double at_m, size_t most) {
  const Result<OctreeStreamInfo> info = CheckOctree(tree, "octree");
  if (!info) return tl::unexpected(info.error());
  LeafCut cut;
  cut.leaf_m = info->resolution;
  if (info->nodes == 0) return cut;
  constexpr std::string_view kHeaderEnd = "\ndata\n";
  const std::string_view text(reinterpret_cast<const char*>(tree.data()), tree.size());
  LeafCutter cutter(tree.subspan(text.find(kHeaderEnd) + kHeaderEnd.size()), axis,
                    std::floor(at_m / cut.leaf_m), cut.leaf_m);
  cutter.Visit(OctreeCube::Everything());
  cut.leaves = std::move(cutter.leaves);
  std::stable_sort(cut.leaves.begin(), cut.leaves.end(),
                   [](const TreeLeaf& a, const TreeLeaf& b) { return a.size_m > b.size_m; });
  if (cut.leaves.size() > most) {
    cut.left_out = cut.leaves.size() - most;
    cut.leaves.resize(most);
  }
  return cut;
}

std::string LeavesText(const LeafCut& cut, const FollowerPosition& position) {
  nlohmann::ordered_json json{{"map_id", position.map_id},
                              {"revision", position.revision},
                              {"leaf_m", cut.leaf_m},
                              {"left_out", cut.left_out},
                              {"leaves", nlohmann::ordered_json::array()}};
  for (const TreeLeaf& leaf : cut.leaves) {
    const auto [x, y, z] = leaf.center_W;
    json["leaves"].push_back({x, y, z, leaf.size_m, leaf.occupied ? 2 : 1});
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace vismap
