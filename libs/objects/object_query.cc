#include "objects/object_query.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "base/class_names.h"

namespace vismap {
namespace {

template <typename T>
bool ParseNumber(std::string_view text, T* number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size();
}

Result<void> SetPart(std::string_view part, ObjectQuery* query) {
  const size_t equals = std::min(part.find('='), part.size());
  const std::string_view key = part.substr(0, equals);
  const std::string value(part.substr(std::min(equals + 1, part.size())));
  if (key == "id") return SetId(value, query);
  if (key == "class") return SetClassOf(value, query);
  if (key == "region") return SetRegion(value, query);
  return Fail("unknown condition for objects '" + std::string(part) +
              "'; expected id=N, class=NAME or region=x0,y0,z0,x1,y1,z1, separated by ';'");
}

/// The smallest box along the axes of W that contains an oriented box.
Eigen::AlignedBox3d BoundsOf(const OrientedBox& box) {
  const Eigen::Vector3d half = box.R_W_B.toRotationMatrix().cwiseAbs() * (0.5 * box.size);
  return {box.center_W - half, box.center_W + half};
}

bool HasSegment(const ObjectSummary& object, SegmentLabel segment) {
  return std::binary_search(object.segments.begin(), object.segments.end(), segment);
}

bool Fits(const ObjectSummary& object, const ObjectQuery& query) {
  if (query.instance && object.instance != *query.instance) return false;
  if (query.segment && !HasSegment(object, *query.segment)) return false;
  if (query.class_id && object.class_id != *query.class_id) return false;
  if (!query.region_W) return true;
  return !object.removed() && BoundsOf(object.box).intersects(*query.region_W);
}

std::string KnownInstances(std::span<const ObjectSummary> objects) {
  std::set<InstanceId> ids;
  for (const ObjectSummary& object : objects) {
    if (!object.discovered()) ids.insert(object.instance);
  }
  std::string known;
  for (const InstanceId id : ids) known += (known.empty() ? "" : ", ") + std::to_string(Raw(id));
  return known.empty() ? "none" : known;
}

bool HasId(std::span<const ObjectSummary> objects, const ObjectQuery& query) {
  const ObjectQuery id{query.instance, query.segment, std::nullopt, std::nullopt};
  return std::any_of(objects.begin(), objects.end(),
                     [&](const ObjectSummary& object) { return Fits(object, id); });
}

}  // namespace

Result<void> SetId(const std::string& text, ObjectQuery* query) {
  std::string_view digits = text;
  const bool is_segment = digits.starts_with("s");
  digits.remove_prefix(digits.starts_with("segment_") ? 8 : is_segment ? 1 : 0);
  uint32_t number = 0;
  if (!ParseNumber(digits, &number) || number == 0) {
    return Fail("'" + text + "' is not the id of an object; expected an instance such as 7, or a " +
                "segment such as s12");
  }
  if (is_segment) {
    query->segment = static_cast<SegmentLabel>(number);
  } else {
    query->instance = static_cast<InstanceId>(number);
  }
  return {};
}

Result<void> SetClassOf(const std::string& text, ObjectQuery* query) {
  query->class_id = ParseClass(text);
  if (!query->class_id) return Fail("'" + text + "' is neither a COCO class nor the id of a class");
  return {};
}

Result<void> SetRegion(const std::string& text, ObjectQuery* query) {
  std::array<double, 6> numbers{};
  std::string_view rest = text;
  bool good = std::count(text.begin(), text.end(), ',') == 5;
  for (double& number : numbers) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    good = good && ParseNumber(part, &number) && std::isfinite(number);
  }
  const Eigen::Map<const Eigen::Vector3d> low(numbers.data()), high(numbers.data() + 3);
  if (!good || !(low.array() <= high.array()).all()) {
    return Fail("'" + text +
                "' is not a region; expected x0,y0,z0,x1,y1,z1 in metres with x0 <= x1, " +
                "y0 <= y1, z0 <= z1");
  }
  query->region_W = Eigen::AlignedBox3d(low, high);
  return {};
}

Result<ObjectQuery> ParseObjectQuery(const std::string& text) {
  ObjectQuery query;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(';'));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    if (const Result<void> set = SetPart(part, &query); !set) return tl::unexpected(set.error());
  }
  return query;
}

std::string ToText(const ObjectQuery& query) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ";") + part; };
  if (query.instance) add("id=" + std::to_string(Raw(*query.instance)));
  if (query.segment) add("id=s" + std::to_string(Raw(*query.segment)));
  if (query.class_id) add("class=" + std::to_string(Raw(*query.class_id)));
  if (!query.region_W) return text;
  std::string region;
  for (const Eigen::Vector3d& corner : {query.region_W->min(), query.region_W->max()}) {
    for (const double number : corner) {
      std::array<char, 32> digits{};
      const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
      region += (region.empty() ? "" : ",") + std::string(digits.data(), end);
    }
  }
  add("region=" + region);
  return text;
}

Result<std::vector<ObjectSummary>> SelectObjects(std::span<const ObjectSummary> objects,
                                                 const ObjectQuery& query) {
  if ((query.instance || query.segment) && !HasId(objects, query)) {
    const std::string id = query.instance ? std::to_string(Raw(*query.instance))
                                          : "s" + std::to_string(Raw(*query.segment));
    return Fail("the map has no object with id " + id + "; its instances are " +
                KnownInstances(objects));
  }
  std::vector<ObjectSummary> selected;
  std::copy_if(objects.begin(), objects.end(), std::back_inserter(selected),
               [&](const ObjectSummary& object) { return Fits(object, query); });
  return selected;
}

}  // namespace vismap
