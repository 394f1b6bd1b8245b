#include "viewer/slice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "base/printable.h"
#include "requests/request_argument.h"
#include "viewer/page_messages.h"
#include "viewer/slice_distances.h"

namespace vismap {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

}  // namespace

Result<SliceQuestion> ReadSlice(const HttpTarget& target) {
  SliceQuestion question;
  for (const auto& [key, value] : target.query) {
    if (key == "axis") {
      const auto found = std::find(kAxes.begin(), kAxes.end(), value);
      if (found == kAxes.end())
        return Fail("axis: expected x, y or z, found '" + PrintableText(value, 60) + "'");
      question.axis = static_cast<int>(found - kAxes.begin());
    } else if (key == "at" || key == "res") {
      const auto number = ReadNumbersOf(key, value, 1);
      if (!number) return tl::unexpected(number.error());
      (key == "at" ? question.at_m : question.cell_m) = number->front();
    } else if (key == "distance") {
      if (value != "0" && value != "1")
        return Fail("distance: expected 0 or 1, found '" + PrintableText(value, 60) + "'");
    } else {
      return Fail("slice: the arguments are axis, at, res and distance, found '" +
                  PrintableText(key, 60) + "'");
    }
  }
  if (!target.query.contains("at")) return Fail("slice: say where with at=METRES");
  if (std::abs(question.at_m) > 1e5) return Fail("at: expected at most 100000 m");
  if (question.cell_m < 0 || question.cell_m > 10) return Fail("res: expected 0 to 10 m");
  return question;
}

bool AsksForDistances(const HttpTarget& target) {
  const auto found = target.query.find("distance");
  return found != target.query.end() && found->second == "1";
}

std::vector<uint8_t> EncodeSlice(const Slice& slice, const SliceQuestion& question,
                                 const FollowerPosition& position, const SliceDistances* distances,
                                 const std::string& problem) {
  const std::array<int, 2> others = OtherAxes(question.axis);
  nlohmann::ordered_json json{
      {"map_id", position.map_id},
      {"revision", position.revision},
      {"axis", kAxes[static_cast<size_t>(question.axis)]},
      {"at_m", question.at_m},
      {"cell_m", slice.cell_m},
      {"origin", {slice.origin_m[0], slice.origin_m[1]}},
      {"width", slice.width},
      {"height", slice.height},
      {"axes", {kAxes[static_cast<size_t>(others[0])], kAxes[static_cast<size_t>(others[1])]}},
      {"layer", slice.layer},
      {"distances", distances != nullptr}};
  if (distances != nullptr) {
    json["distance_leaf_m"] = distances->leaf_m;
    json["distance_limit_m"] = distances->limit_m;
  }
  if (!problem.empty()) json["distances_problem"] = problem;
  std::vector<uint8_t> bytes =
      JsonHeader(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  bytes.insert(bytes.end(), slice.states.begin(), slice.states.end());
  if (distances == nullptr) return bytes;
  const size_t begin = (bytes.size() + 3) / 4 * 4;
  bytes.resize(begin + distances->metres.size() * sizeof(float));
  std::memcpy(bytes.data() + begin, distances->metres.data(), bytes.size() - begin);
  return bytes;
}

tl::expected<const Slice*, HttpAnswer> SliceAnswers::Find(const SliceQuestion& question,
                                                          const OccupancyMap& map,
                                                          const FollowerPosition& position,
                                                          double now) {
  return Find(
      question, map.cell_size(), [&] { return &map; }, position, now);
}

tl::expected<const Slice*, HttpAnswer> SliceAnswers::Find(const SliceQuestion& question,
                                                          double cell_size_m,
                                                          const FindMap& find_map,
                                                          const FollowerPosition& position,
                                                          double now) {
  const Key key{position.map_id, position.revision, question.axis,
                std::floor(question.at_m / cell_size_m), question.cell_m};
  if (!kept_ || *kept_ != key) {
    tokens_ = std::min(kMostPerSecond, tokens_ + kMostPerSecond * std::max(0.0, now - filled_));
    filled_ = now;
    if (tokens_ < 1)
      return tl::unexpected(
          ErrorAnswer(429, "more than 10 slices per second over all pages; try again"));
    tokens_ -= 1;
    const auto map = find_map();
    if (!map) return tl::unexpected(map.error());
    Result<Slice> slice = CutSlice(**map, question);
    if (!slice) return tl::unexpected(ErrorAnswer(400, slice.error().message));
    slice_ = std::move(*slice);
    kept_ = key;
  }
  return &slice_;
}

}  // namespace vismap
