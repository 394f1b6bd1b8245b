#pragma once

#include <string>

#include "evaluation/evaluation.h"

namespace vismap {

/// All scores as a JSON object; null = nothing to measure. AP, mAP, PQ, SQ, RQ, recall and
/// discovery are percentages; other shares are in [0, 1]; keys that end in _m are metres. The top
/// level has the surface errors, the ranked AP (classes, mAP50, mAP50_95) and the discovery scores.
/// Then follows one object per metric: scannet_ap, panoptic, surface, and free_space with an entry
/// per cell size. `objects` has an entry per true object that is counted: what became of it
/// (ObjectFinding), with shares in [0, 1].
std::string EvaluationJson(const Evaluation& evaluation);

/// The scores as text: a table in the layout of the paper's Table I, and a few lines.
std::string EvaluationTable(const Evaluation& evaluation);

/// What the map made of each true object, the worst first, as a table: IoU, the share of the object
/// that its best group covers, the share of that group that is the object [%], the number of
/// pieces, and what swallowed it.
std::string FindingsTable(const Evaluation& evaluation);

}  // namespace vismap
