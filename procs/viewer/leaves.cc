#include "viewer/leaves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "freespace/octree.h"
#include "freespace/octree_cube.h"
#include "requests/request_argument.h"

namespace vismap {
namespace {

constexpr std::array<const char*, 3> kLeafAxes = {"x", "y", "z"};
constexpr double kMostMetres = 1e5, kMostRadius = 10;

/// Reads nodes that CheckOctree has checked, and keeps the leaves of one layer: of each size at
/// most `most`, so that its memory is bounded for any tree.
class LeafCutter {
 public:
  LeafCutter(std::span<const uint8_t> nodes, int axis, double layer, double leaf_m, size_t most)
      : nodes_(nodes),
        axis_(static_cast<size_t>(axis)),
        layer_(layer),
        leaf_m_(leaf_m),
        most_(most) {}

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
  /// The largest ones.
  LeafCut Take() {
    LeafCut cut{leaf_m_, {}, left_out_};
    for (auto size = leaves_.rbegin(); size != leaves_.rend(); ++size) {
      const size_t taken = std::min(size->size(), most_ - cut.leaves.size());
      cut.leaves.insert(cut.leaves.end(), size->begin(),
                        size->begin() + static_cast<std::ptrdiff_t>(taken));
      cut.left_out += size->size() - taken;
    }
    return cut;
  }

 private:
  void Add(const OctreeCube& cube, bool occupied) {
    const std::array<int32_t, 3> min{cube.min.x, cube.min.y, cube.min.z};
    if (layer_ < min[axis_] || layer_ >= min[axis_] + cube.size) return;
    auto& same_size =
        leaves_[static_cast<size_t>(std::countr_zero(static_cast<uint32_t>(cube.size)))];
    if (same_size.size() >= most_) {
      ++left_out_;
      return;
    }
    TreeLeaf leaf{{}, cube.size * leaf_m_, occupied};
    for (size_t i = 0; i < 3; ++i) leaf.center_W[i] = (min[i] + 0.5 * cube.size) * leaf_m_;
    same_size.push_back(leaf);
  }

  std::span<const uint8_t> nodes_;
  size_t axis_;
  double layer_, leaf_m_;  // layer: number of the smallest leaves on the axis
  size_t most_, at_ = 0, left_out_ = 0;
  std::array<std::vector<TreeLeaf>, 16> leaves_;  // by the logarithm of their size
};

/// The leaves of a stream that CheckOctree has checked.
LeafCut CutChecked(std::span<const uint8_t> tree, const OctreeStreamInfo& info, int axis,
                   double at_m, size_t most) {
  if (info.nodes == 0) return {info.resolution, {}, 0};
  constexpr std::string_view kHeaderEnd = "\ndata\n";
  const std::string_view text(reinterpret_cast<const char*>(tree.data()), tree.size());
  LeafCutter cutter(tree.subspan(text.find(kHeaderEnd) + kHeaderEnd.size()), axis,
                    std::floor(at_m / info.resolution), info.resolution, most);
  cutter.Visit(OctreeCube::Everything());
  return cutter.Take();
}

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
  return CutChecked(tree, *info, axis, at_m, most);
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

bool LeafAnswers::Keeps(const LeafQuestion& question, const FollowerPosition& map,
                        double now) const {
  return IsOf(question) && position_.map_id == map.map_id &&
         (now < until_ || position_.revision == map.revision);
}

void LeafAnswers::Refill(double now) {
  tokens_ = std::min(kMostPerSecond, tokens_ + kMostPerSecond * std::max(0.0, now - filled_));
  filled_ = now;
}

bool LeafAnswers::MayCut(double now) {
  Refill(now);
  return tokens_ >= 1;
}

HttpAnswer LeafAnswers::Refusal() {
  return ErrorAnswer(429, "more cuts through octrees are asked for than can be made; try again");
}

HttpAnswer LeafAnswers::Cut(const LeafQuestion& question, double now) {
  return MayCut(now) ? CutKept(question) : Refusal();
}

HttpAnswer LeafAnswers::Take(const LeafQuestion& question, const FollowerPosition& position,
                             std::span<const uint8_t> tree, double now) {
  const bool same =
      IsOf(question) && std::equal(tree.begin(), tree.end(), tree_.begin(), tree_.end());
  if (!same) {
    Refill(now);
    Pay(tree.size());
    const Result<OctreeStreamInfo> info = CheckOctree(tree, "octree");
    if (!info) return ErrorAnswer(504, info.error().message);
    info_ = *info;
    closed_ = question.closed;
    inflate_m_ = question.inflate_m;
    tree_.assign(tree.begin(), tree.end());
  }
  position_ = position;
  until_ = now + kept_;
  return same ? Cut(question, now) : CutKept(question);
}

bool LeafAnswers::IsOf(const LeafQuestion& question) const {
  return info_ && closed_ == question.closed && inflate_m_ == question.inflate_m;
}

void LeafAnswers::Pay(size_t bytes) {
  tokens_ -= std::max(1.0, static_cast<double>(bytes) / kBytesPerToken);
}

HttpAnswer LeafAnswers::CutKept(const LeafQuestion& question) {
  Pay(tree_.size());
  const LeafCut cut = CutChecked(tree_, *info_, question.axis, question.at_m, kMostCutLeaves);
  return JsonAnswer(LeavesText(cut, position_));
}

}  // namespace vismap
