#include "map_server/object_links.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/format.h"

namespace vismap {
namespace {

// Pixels of each object of the one map, by object of the other; InstanceId::kNone for the rest.
using SharedPixels = std::map<InstanceId, std::map<InstanceId, int64_t>>;

InstanceId ObjectOf(SegmentLabel label, const SeenMap& map) {
  if (label == SegmentLabel::kNone) return InstanceId::kNone;
  const InstanceId instance = map.labels.Read(label).instance;
  return map.objects.contains(instance) ? instance : InstanceId::kNone;
}

struct SharedBothWays {
  SharedPixels of_before, of_after;
};

SharedBothWays CountShared(const SeenMap& before, const SeenMap& after) {
  SharedBothWays shared;
  for (const auto& [revision, segments] : before.seen) {
    const auto other = after.seen.find(revision);
    if (other == after.seen.end() || other->second.size() != segments.size()) continue;
    for (size_t i = 0; i < segments.size(); ++i) {
      const InstanceId old_object = ObjectOf(segments[i].label, before);
      const InstanceId new_object = ObjectOf(other->second[i].label, after);
      shared.of_before[old_object][new_object] += segments[i].pixels;
      shared.of_after[new_object][old_object] += segments[i].pixels;
    }
  }
  shared.of_before.erase(InstanceId::kNone);
  shared.of_after.erase(InstanceId::kNone);
  return shared;
}

// The object that more than half of the pixels belong to; kNone = there is none.
InstanceId MostOf(const std::map<InstanceId, int64_t>& pixels) {
  int64_t all = 0;
  for (const auto& [object, count] : pixels) all += count;
  for (const auto& [object, count] : pixels) {
    if (2 * count > all) return object;
  }
  return InstanceId::kNone;
}

// For each object of the one map that has one, the object that it is mostly of the other.
std::map<InstanceId, InstanceId> MostOfEach(const SharedPixels& shared) {
  std::map<InstanceId, InstanceId> most;
  for (const auto& [object, pixels] : shared) {
    const InstanceId other = MostOf(pixels);
    if (other != InstanceId::kNone) most.emplace(object, other);
  }
  return most;
}

// The objects that several others are mapped to, with these.
std::map<InstanceId, std::vector<InstanceId>> Several(
    const std::map<InstanceId, InstanceId>& most) {
  std::map<InstanceId, std::vector<InstanceId>> several;
  for (const auto& [object, other] : most) several[other].push_back(object);
  std::erase_if(several, [](const auto& entry) { return entry.second.size() < 2; });
  return several;
}

std::string Text(const std::vector<InstanceId>& objects) {
  std::string text;
  for (size_t i = 0; i < objects.size(); ++i)
    text += (i == 0                    ? ""
             : i + 1 == objects.size() ? " and "
                                       : ", ") +
            std::to_string(Raw(objects[i]));
  return text;
}

nlohmann::json Numbers(const std::vector<InstanceId>& objects) {
  nlohmann::json numbers = nlohmann::json::array();
  for (const InstanceId object : objects) numbers.push_back(Raw(object));
  return numbers;
}

}  // namespace

std::vector<SeenSegment> SeenIn(const SegmentedFrame& frame, const FrameAssociation& association) {
  std::vector<SeenSegment> seen;
  for (size_t i = 0; i < std::min(frame.segments.size(), association.segments.size()); ++i)
    seen.push_back({association.segments[i].label, frame.segments[i].pixels});
  return seen;
}

ObjectLinks LinkObjects(const SeenMap& before, const SeenMap& after) {
  const SharedBothWays shared = CountShared(before, after);
  const std::map<InstanceId, InstanceId> origins = MostOfEach(shared.of_after);
  ObjectLinks links;
  links.became = MostOfEach(shared.of_before);
  links.joined = Several(links.became);
  links.split = Several(origins);
  std::set<InstanceId> reached;
  for (const auto& [old_object, new_object] : links.became) reached.insert(new_object);
  for (const auto& [object, pixels] : shared.of_before) {
    if (!links.became.contains(object) && !links.split.contains(object))
      links.gone.push_back(object);
  }
  for (const auto& [object, pixels] : shared.of_after) {
    if (!reached.contains(object) && !origins.contains(object)) links.came.push_back(object);
  }
  return links;
}

std::string Sentence(const ObjectLinks& links) {
  constexpr size_t kShown = 5;  // of joined and of split ones
  const auto count = [](size_t n) { return FormatCount(static_cast<int64_t>(n), "object"); };
  std::string text = count(links.became.size()) + " found again";
  size_t shown = 0;
  for (const auto& [object, parts] : links.joined) {
    if (shown++ < kShown) text += ", " + Text(parts) + " joined to " + std::to_string(Raw(object));
  }
  if (shown > kShown) text += ", " + std::to_string(shown - kShown) + " more joined ones";
  shown = 0;
  for (const auto& [object, parts] : links.split) {
    if (shown++ < kShown) text += ", " + std::to_string(Raw(object)) + " split to " + Text(parts);
  }
  if (shown > kShown) text += ", " + std::to_string(shown - kShown) + " more split ones";
  if (!links.gone.empty()) text += ", " + count(links.gone.size()) + " gone";
  if (!links.came.empty()) text += ", " + count(links.came.size()) + " new";
  return text;
}

std::string LinksJson(const ObjectLinks& links) {
  nlohmann::ordered_json json;
  for (const char* key : {"became", "joined", "split"}) json[key] = nlohmann::json::array();
  for (const auto& [before, after] : links.became)
    json["became"].push_back({Raw(before), Raw(after)});
  for (const auto& [after, before] : links.joined)
    json["joined"].push_back({Numbers(before), Raw(after)});
  for (const auto& [before, after] : links.split)
    json["split"].push_back({Raw(before), Numbers(after)});
  json["gone"] = Numbers(links.gone);
  json["came"] = Numbers(links.came);
  return json.dump();
}

}  // namespace vismap
