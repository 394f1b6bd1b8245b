#include "map_tool/object_table.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/class_names.h"
#include "base/json_text.h"
#include "base/printable.h"

namespace vismap {
namespace {

/// The id that --id accepts: an instance, or "s" and a segment.
std::string IdOf(const nlohmann::json& object) {
  const int instance = object.at("instance").get<int>();
  return instance != 0 ? std::to_string(instance)
                       : "s" + std::to_string(object.at("segments").at(0).get<int>());
}

std::string ClassOf(const nlohmann::json& object) {
  return PrintableText(object.at("class_name").get<std::string>());
}

/// "chair 0.93, couch 0.07": at most three classes, the most probable first.
std::string Probabilities(const nlohmann::json& object) {
  std::vector<std::pair<double, int>> shares;
  const auto all = object.value("class_probabilities", nlohmann::json::object());
  for (const auto& [id, share] : all.items())
    shares.emplace_back(-share.get<double>(), std::stoi(id));
  std::sort(shares.begin(), shares.end());
  std::string text;
  for (size_t i = 0; i < std::min<size_t>(shares.size(), 3); ++i) {
    char number[16];
    std::snprintf(number, sizeof(number), " %.2f", -shares[i].first);
    text += (i > 0 ? ", " : "") + ClassName(static_cast<ClassId>(shares[i].second)) + number;
  }
  return text;
}

/// A time [s] that is stored in us.
double Seconds(const nlohmann::json& object, const char* key) {
  return static_cast<double>(object.at(key).get<int64_t>()) * 1e-6;
}

void PrintObject(const nlohmann::json& object) {
  const auto& size = object.at("size");
  const auto& center = object.at("center");
  std::printf(
      "%8s  %-16s %5.2f  %7d %7.3f  %5.2f x %5.2f x %5.2f  (%6.2f, %6.2f, %6.2f) %7d  "
      "%.1f..%.1f  %s\n",
      IdOf(object).c_str(), ClassOf(object).c_str(), object.at("score").get<double>(),
      object.at("points").get<int>(), object.at("area").get<double>(), size[0].get<double>(),
      size[1].get<double>(), size[2].get<double>(), center[0].get<double>(),
      center[1].get<double>(), center[2].get<double>(), object.at("frames").get<int>(),
      Seconds(object, "first_utime"), Seconds(object, "last_utime"), Probabilities(object).c_str());
}

void PrintRemoved(const nlohmann::json& object) {
  std::printf("%8s  %-16s removed: last seen at %.1f s, found missing at %.1f s\n",
              IdOf(object).c_str(), ClassOf(object).c_str(), Seconds(object, "last_utime"),
              Seconds(object, "removed_utime"));
}

}  // namespace

void PrintObjects(const std::string& objects_json, bool all) {
  const nlohmann::json list = ParseJson(objects_json).value();
  std::printf("%8s  %-16s %5s  %7s %7s  %-21s  %-24s %7s  %s\n", "id", "class", "score", "points",
              "area m2", "size [m]", "center [m]", "frames", "seen [s]  probabilities");
  for (const auto& object : list.at("objects")) PrintObject(object);
  for (const char* name : {"discovered", "structure"}) {
    for (const auto& segment : list.at(name)) {
      if (all) PrintObject(segment);
    }
  }
  for (const auto& object : list.at("removed")) PrintRemoved(object);
  if (!all) {
    std::printf(
        "Not shown (see --json): %zu discovered segments without a class, and %zu of structure.\n",
        list.at("discovered").size(), list.at("structure").size());
  }
}

}  // namespace vismap
