#include "exports/objects_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace vismap {
namespace {

using Json = nlohmann::ordered_json;

// Rounded to 1e-6. Adding 0 turns -0 into 0.
double Rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

Json ToJson(const Eigen::Vector3d& v) { return {Rounded(v.x()), Rounded(v.y()), Rounded(v.z())}; }

// A rotation has two quaternions; this writes the one with w >= 0.
Json ToJson(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1 : 1;
  return {Rounded(sign * q.x()), Rounded(sign * q.y()), Rounded(sign * q.z()),
          Rounded(sign * q.w())};
}

// {"class id": probability, ...}
Json Probabilities(const ObjectSummary& object) {
  Json shares = Json::object();
  for (const auto& [class_id, share] : object.class_probability) {
    shares[std::to_string(Raw(class_id))] = Rounded(share);
  }
  return shares;
}

Json ToJson(const ObjectSummary& object, const ClassNamer& class_name) {
  Json json;
  json["instance"] = Raw(object.instance);
  json["class"] = Raw(object.class_id);
  json["class_name"] = object.discovered() ? "unknown" : class_name(object.class_id);
  json["score"] = Rounded(object.score);
  json["segments"] = Json::array();
  for (const SegmentLabel label : object.segments) json["segments"].push_back(Raw(label));
  json["points"] = object.points;
  if (!object.removed()) {
    json["center"] = ToJson(object.box.center_W);
    json["size"] = ToJson(object.box.size);
    json["orientation"] = ToJson(object.box.R_W_B);
  }
  json["frames"] = object.frames;
  json["area"] = Rounded(object.area);
  json["first_utime"] = object.first_utime;
  json["last_utime"] = object.last_utime;
  json["state"] = object.removed() ? "removed" : "present";
  if (object.removed()) json["removed_utime"] = object.removed_utime;
  if (object.discovered()) {
    json["structure"] = object.is_structure();
    if (object.is_structure()) json["kind"] = NameOf(object.structure);
  } else {
    json["class_probabilities"] = Probabilities(object);
  }
  return json;
}

// A JSON array with one element per line. The JSON library can only write everything on one line or
// every number on a line of its own. Bytes of names that are not UTF-8 are replaced, because the
// library would throw an exception for them.
std::string Lines(const std::vector<Json>& list) {
  std::string text = "[";
  for (size_t i = 0; i < list.size(); ++i) {
    text +=
        (i == 0 ? "\n  " : ",\n  ") + list[i].dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return text + (list.empty() ? "]" : "\n]");
}

}  // namespace

std::string ObjectsJson(const std::string& map_id, const UpDirection& up,
                        std::span<const ObjectSummary> objects, const ClassNamer& class_name) {
  std::vector<Json> named, discovered, structure, removed;
  for (const ObjectSummary& object : objects) {
    auto& list = object.removed()        ? removed
                 : object.is_structure() ? structure
                 : object.discovered()   ? discovered
                                         : named;
    list.push_back(ToJson(object, class_name));
  }
  const std::string id = Json(map_id).dump(-1, ' ', false, Json::error_handler_t::replace);
  const Json direction = {{"direction", ToJson(up.up_W)}, {"reason", up.reason}};
  return "{\"map_id\":" + id + ",\n\"up\":" + direction.dump() + ",\n\"objects\":" + Lines(named) +
         ",\n\"discovered\":" + Lines(discovered) + ",\n\"structure\":" + Lines(structure) +
         ",\n\"removed\":" + Lines(removed) + "}\n";
}

}  // namespace vismap
