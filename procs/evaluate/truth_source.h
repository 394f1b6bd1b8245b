#pragma once

#include <memory>
#include <string>

#include "datasets/dataset.h"
#include "evaluation/ground_truth.h"
#include "evaluation/scores.h"

namespace vismap {

/// A ground truth, and the data for evaluating free space.
struct TruthSource {
  GroundTruth truth;
  /// The depth images of the sequence, or why they are not available.
  Result<std::unique_ptr<Dataset>> depth = nullptr;
  TrueDistance distance{};  ///< distance to the true surface; empty = unknown
};

/// Opens the ground truth of a folder (see ReadGroundTruth) with the images in it, or that of a
/// synthetic sequence, which is the part of the scene that an ideal camera sees on one tour, as
/// triangles of 2 cm.
Result<TruthSource> OpenTruth(const std::string& path);

}  // namespace vismap
