#include "evaluation/class_list.h"

#include <map>
#include <set>
#include <sstream>

#include "base/class_names.h"

namespace vismap {
namespace {

// The classes of the objects in the ground truth, ascending by id.
std::vector<EvaluatedClass> SceneClasses(const GroundTruth& truth) {
  std::set<ClassId> ids;
  for (const TrueObject& object : truth.objects) {
    if (object.class_id != ClassId::kUnknown) ids.insert(object.class_id);
  }
  std::vector<EvaluatedClass> classes;
  for (const ClassId id : ids) classes.push_back({ClassName(id), id});
  return classes;
}

}  // namespace

std::vector<EvaluatedClass> PaperClasses() {
  return {{"bed", ClassId{65}},
          {"chair", ClassId{62}},
          {"sofa", ClassId{63}},
          {"table", ClassId{67}},
          {"books", ClassId{84}},
          {"refrigerator", ClassId{82}},
          {"television", ClassId{72}},
          {"toilet", ClassId{70}},
          {"bag", ClassId{27}, {ClassId{31}, ClassId{33}}}};
}

std::optional<ClassId> PaperClassFromName(std::string_view name) {
  static const std::map<std::string_view, ClassId> kOthers{
      {"fridge", ClassId{82}}, {"refridgerator", ClassId{82}}, {"tv", ClassId{72}}};
  for (const EvaluatedClass& known : PaperClasses()) {
    if (known.name == name) return known.class_id;
  }
  const auto found = kOthers.find(name);
  return found == kOthers.end() ? std::nullopt : std::optional(found->second);
}

Result<std::vector<EvaluatedClass>> ParseClassList(const std::string& text,
                                                   const GroundTruth& truth) {
  if (text == "scene" || (text.empty() && truth.format == "synthetic")) return SceneClasses(truth);
  if (text == "paper" || text.empty()) return PaperClasses();
  std::vector<EvaluatedClass> classes;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::optional<ClassId> paper = PaperClassFromName(word);
    const std::optional<ClassId> id = paper ? paper : ClassFromName(word);
    if (!id || *id == ClassId::kUnknown)
      return Fail("classes: expected paper, scene or names of COCO classes, found '" + word + "'");
    classes.push_back({word, *id});
  }
  return classes;
}

}  // namespace vismap
