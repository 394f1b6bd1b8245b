#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/class_list.h"
#include "evaluation/discovery.h"
#include "evaluation/free_space.h"
#include "evaluation/object_findings.h"
#include "evaluation/panoptic.h"
#include "evaluation/ranked_ap.h"
#include "evaluation/scannet_ap.h"
#include "evaluation/scores.h"
#include "evaluation/surface_error.h"

namespace vismap {

/// How a map is evaluated.
struct EvaluationOptions {
  double radius = 0.05;    ///< of the label transfer and of DistanceSummary::within_radius [m]
  ScanNetOptions scannet;  ///< its confidence is set by Evaluate
  RankedApOptions ranked;  ///< its scores are set by Evaluate
  DiscoveryOptions discovery;
  int64_t panoptic_min_vertices = 60;  ///< objects and predictions with fewer points are left out
};

/// The map to evaluate, as users see it.
struct EvaluatedMap {
  Mesh mesh;
  /// Scores of the instances, [0, 1]. If not set, AP with real confidences is left out.
  std::optional<std::map<InstanceId, double>> scores;
};

/// All scores of one class.
struct ClassEvaluation {
  EvaluatedClass known;
  ScanNetEvidence at50;                 ///< matches with constant confidence at IoU > 0.5
  ScanNetAp constant;                   ///< ScanNet's AP with constant confidence, as in Table I
  std::optional<ScanNetAp> with_score;  ///< ScanNet's AP with the map's scores as confidences
  RankedAp ranked;
  PanopticScore panoptic;
};

/// Means over the classes that the scene has; not set if it has none of the classes.
struct MeanPanoptic {
  std::optional<double> pq, sq, rq;  ///< sq is the mean over the classes with matches
};

/// How correct the free and occupied cells of a map are, for one size of cells.
struct FreeSpaceEvaluation {
  double cell_size = 0;  ///< [m]
  CellShares truth;      ///< states of the cells at the points of the ground truth
  OccupiedCells occupied;
  std::optional<RayScore> rays;            ///< only with the depth images
  std::optional<FreeSpaceScore> analytic;  ///< only of computed scenes
};

/// All scores of a map.
struct Evaluation {
  std::string truth_name, truth_format;
  size_t truth_points = 0, truth_objects = 0, map_vertices = 0;
  int pred_instances = 0;  ///< instances with a class and at least 10 points of the ground truth
  std::vector<ClassEvaluation> classes;  ///< in the given order
  ScanNetAp constant_mean;
  std::optional<ScanNetAp> score_mean;
  RankedAp ranked_mean;
  MeanPanoptic panoptic;
  PanopticScore any_class_panoptic;  ///< all objects of any class against MatchGroups
  /// ScanNet's AP without classes: all true objects but structure against all groups of the map,
  /// as ScanNet200's script gives it when all classes are one.
  ScanNetAp any_class_ap;
  /// The same with the map's scores as confidences; segments without an instance come last.
  std::optional<ScanNetAp> any_class_score_ap;
  AnyClassScore any_class;
  std::vector<TrueObject> truths;       ///< the objects of the ground truth
  std::vector<ObjectFinding> findings;  ///< what the map made of each of `truths` that is counted
  SurfaceError surface;
  std::vector<FreeSpaceEvaluation> free_space;  ///< set by the caller; needs the voxels of the map
};

/// Computes all scores except those of free space.
Evaluation Evaluate(const GroundTruth& truth, const EvaluatedMap& map,
                    const std::vector<EvaluatedClass>& classes, EvaluationOptions options = {});

}  // namespace vismap
