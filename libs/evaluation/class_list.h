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
  std::string name;  ///< column of tables
  ClassId class_id = ClassId::kUnknown;
  /// Classes that the ranked AP counts as this one, too (see ranked_ap.h).
  std::vector<ClassId> aliases{};
};

/// The nine of Table I (ALGORITHM 7.3), in its order; bag is COCO's backpack.
std::vector<EvaluatedClass> PaperClasses();

/// Which of the nine a name of a SceneNN annotation means ("fridge", "refrigerator", "tv" ...).
std::optional<ClassId> PaperClassFromName(std::string_view name);

/// "paper": the nine; "scene": all classes that the ground truth has, ascending by id; else COCO
/// names or names of the nine, with commas between. Empty = paper, but scene for computed scenes.
/// Fails naming a word that is no class.
Result<std::vector<EvaluatedClass>> ParseClassList(const std::string& text,
                                                   const GroundTruth& truth);

}  // namespace vismap
