#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vismap {

/// All figures as a JSON object; null = there is nothing to measure. AP, mAP, PQ, SQ, RQ, recall
/// and discovery are percentages, all other shares lie in [0, 1], keys in _m are metres. At the top
/// stand the figures that a mesh alone can be scored by: those of the ranked AP (classes, mAP50,
/// mAP50_95), of finding things, and of the surface. Then one object per metric: scannet_ap,
/// panoptic, surface; and free_space, an entry per size of cells.
std::string EvaluationJson(const Evaluation& evaluation);

/// The same for people: a table in the layout of the paper's Table I, and a few lines.
std::string EvaluationTable(const Evaluation& evaluation);

}  // namespace vismap
