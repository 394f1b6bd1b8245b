#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vismap {

/// All figures as a JSON object, one line per figure. AP, PQ and recalls in percent, other shares
/// in [0, 1], lengths in metres, as the key says; null = there is nothing to measure. At the top
/// stand the figures that a mesh alone can be scored by, rounded as stated there; then one object
/// per metric: scannet_ap, panoptic, surface, free_space.
std::string EvaluationJson(const Evaluation& evaluation);

/// The same for people: a table in the layout of the paper's Table I, and a few lines.
std::string EvaluationTable(const Evaluation& evaluation);

}  // namespace vismap
