#pragma once

#include <string>
#include <vector>

#include "base/reason_counts.h"
#include "datasets/dataset.h"
#include "geometry/surface_options.h"
#include "plausibility/sequence_check.h"

namespace vismap {

/// What is wrong or suspect about a sequence before it is used.
struct RecordingCheck {
  std::vector<std::string> findings;  ///< see SequenceCheck and FindingsOf(DepthLosses)
  ReasonCounts left_out;              ///< frames that cannot be used, as far as they were read
  ReasonCounts without_color;         ///< frames whose colour cannot be decoded, likewise
};

/// How many images are read to judge a sequence.
enum class CheckedFrames {
  kAFewDozen,  ///< of the whole sequence, which is enough to judge its poses
  kAll,
};

/// Judges a sequence as the offline mapper does while it maps it. `limits` are those of the
/// mapping, `surface` those of depth.
RecordingCheck CheckRecording(const Dataset& dataset, const DepthLimits& limits,
                              const SurfaceOptions& surface, CheckedFrames frames);

}  // namespace vismap
