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
  double within_radius = 0;    ///< share of the distances below the radius
};

/// How well the surface of a map agrees with the true one. Not set if there is nothing to measure.
struct SurfaceError {
  /// Distances from vertices of the map to the true surface: how wrong the mapped surface is. At
  /// most 100 000 vertices are used, evenly chosen.
  std::optional<DistanceSummary> accuracy;
  /// Distances from the points of the truth to the nearest vertex of the map: how much is missing.
  std::optional<DistanceSummary> completeness;
};

/// Statistics of distances [m], which may be infinite; none if there are no distances. For the
/// mean, each distance is limited to `cap` [m]; 0 = no limit. `radius` [m] is that of
/// within_radius.
std::optional<DistanceSummary> SummarizeDistances(std::vector<double> distances, double radius,
                                                  double cap = 0);

/// Compares two surfaces. The distance to the true surface is that to the nearest of the 12
/// triangles with the nearest centroids, or to the nearest point if the truth has no triangles. In
/// the mean completeness, distances above 20 cm count as 20 cm, because the distance of surface
/// that was never mapped has no meaning.
SurfaceError ScoreSurface(const GroundTruth& truth, const Mesh& mesh,
                          const TransferredLabels& labels, double radius);

}  // namespace vismap
