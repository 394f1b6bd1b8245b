#pragma once

#include <memory>
#include <string>

#include "datasets/dataset.h"
#include "evaluation/ground_truth.h"
#include "evaluation/scores.h"

namespace vismap {

/// A ground truth and what else is known beside it.
struct TruthSource {
  GroundTruth truth;
  /// The images that a map was made of, or why they are not at hand.
  Result<std::unique_ptr<Dataset>> depth = nullptr;
  TrueDistance distance{};  ///< empty = unknown
};

/// Opens a folder (see ReadGroundTruth; the images are those inside it) or a computed sequence: the
/// part of its scene that an ideal camera on one tour sees, in triangles of 2 cm.
Result<TruthSource> OpenTruth(const std::string& path);

}  // namespace vismap
