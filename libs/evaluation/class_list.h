#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "evaluation/ground_truth.h"

namespace vismap {

/// A class that is scored by itself.
struct EvaluatedClass {
  std::string name;  ///< title of its column in tables
  ClassId class_id = ClassId::kUnknown;
  /// Other classes that the ranked AP counts as this one (see ranked_ap.h).
  std::vector<ClassId> aliases{};
};

/// The nine classes of Table I of the paper (Grinvald 2019, Sec. IV), in its order. "bag" is COCO's
/// backpack; see libs/METHOD.md, Evaluation.
std::vector<EvaluatedClass> PaperClasses();

/// The class of the nine that a name in a SceneNN annotation means ("fridge", "refrigerator",
/// "tv", ...). None for other names.
std::optional<ClassId> PaperClassFromName(std::string_view name);

/// Parses a list of classes: "paper" = the nine classes above; "scene" = all classes of the ground
/// truth, ascending by id; otherwise COCO names or names of the nine, separated by commas. An empty
/// text means "scene" for computed scenes, else "paper". Fails, naming the word, if it is not a
/// class.
Result<std::vector<EvaluatedClass>> ParseClassList(const std::string& text,
                                                   const GroundTruth& truth);

}  // namespace vismap
