#pragma once

#include <optional>
#include <vector>

#include "evaluation/ground_truth.h"
#include "evaluation/transfer.h"

namespace vismap {

/// Statistics of unsigned distances [m].
struct DistanceSummary {
  size_t samples = 0;
  double mean = 0;
  double median = 0, p95 = 0;  ///< percentiles, linear between samples
  double within_radius = 0;    ///< share below the radius
};

/// How well two surfaces agree; none where there is nothing to measure.
struct SurfaceError {
  /// From the map to the truth: how wrong is what was mapped. Up to 100 000 vertices, evenly taken.
  std::optional<DistanceSummary> accuracy;
  /// From the truth's points to the map's nearest vertex: how much is missing.
  std::optional<DistanceSummary> completeness;
};

/// `distances` may be infinite. `cap` bounds each distance [m] for the mean; 0 = not.
std::optional<DistanceSummary> SummarizeDistances(std::vector<double> distances, double radius,
                                                  double cap = 0);

/// Distances are to the nearest of the 12 triangles with the nearest centroids, and to points where
/// the truth has no triangles. The mean completeness counts distances above 20 cm as 20 cm, since
/// what was never mapped has no meaningful distance.
SurfaceError ScoreSurface(const GroundTruth& truth, const Mesh& mesh,
                          const TransferredLabels& labels, double radius);

}  // namespace vismap
