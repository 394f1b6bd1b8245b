#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/class_list.h"
#include "evaluation/discovery.h"
#include "evaluation/free_space.h"
#include "evaluation/panoptic.h"
#include "evaluation/ranked_ap.h"
#include "evaluation/scannet_ap.h"
#include "evaluation/scores.h"
#include "evaluation/surface_error.h"

namespace vismap {

struct EvaluationOptions {
  double radius = 0.05;    ///< of the transfer to the truth's points, and of "within" [m]
  ScanNetOptions scannet;  ///< its confidence is set by Evaluate
  RankedApOptions ranked;  ///< its scores are set by Evaluate
  DiscoveryOptions discovery;
  int64_t panoptic_min_vertices = 60;  ///< objects and predictions with fewer points are left out
};

/// A map as its users see it.
struct EvaluatedMap {
  Mesh mesh;
  /// Of the instances, [0, 1]; none = not told, which leaves AP with real confidence out.
  std::optional<std::map<InstanceId, double>> scores;
};

/// All of one class.
struct ClassEvaluation {
  EvaluatedClass known;
  ScanNetEvidence at50;                 ///< constant confidence, IoU > 0.5: counts
  ScanNetAp constant;                   ///< ScanNet's AP without ranking: the paper's Table I
  std::optional<ScanNetAp> with_score;  ///< the same, ranked by the map's scores
  RankedAp ranked;
  PanopticScore panoptic;
};

/// Means over the classes that the scene has; none = it has none.
struct MeanPanoptic {
  std::optional<double> pq, sq, rq;  ///< sq over the classes with matches
};

/// What a map keeps for planners, in cells of one size.
struct FreeSpaceEvaluation {
  double cell_size = 0;  ///< [m]
  CellShares truth;      ///< at the truth's points
  InventedCells invented;
  std::optional<RayScore> rays;            ///< where depth images are at hand
  std::optional<FreeSpaceScore> analytic;  ///< where the true distance is known
};

/// How good a map is.
struct Evaluation {
  std::string truth_name, truth_format;
  size_t truth_points = 0, truth_objects = 0, map_vertices = 0;
  int pred_instances = 0;  ///< instances with a class on at least ten points of the truth
  std::vector<ClassEvaluation> classes;  ///< as listed
  ScanNetAp constant_mean;
  std::optional<ScanNetAp> score_mean;
  RankedAp ranked_mean;
  MeanPanoptic panoptic;
  PanopticScore any_class_panoptic;  ///< all objects, any class, groups as MatchGroups has them
  AnyClassScore any_class;
  SurfaceError surface;
  std::vector<FreeSpaceEvaluation> free_space;  ///< the caller's, since only saved maps have it
};

/// Everything but free space.
Evaluation Evaluate(const GroundTruth& truth, const EvaluatedMap& map,
                    const std::vector<EvaluatedClass>& classes, EvaluationOptions options = {});

}  // namespace vismap
