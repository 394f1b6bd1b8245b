#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "evaluation/report.h"

namespace vismap {
namespace {

using Json = nlohmann::ordered_json;

// Rounds decimals like Python's round(), halves to even, so that figures of Python scorers are
// equal.
double Rounded(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return std::strtod(text, nullptr);
}

Json Share(const std::optional<double>& value, int digits) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return Rounded(*value, digits);
}

Json JsonPercent(const std::optional<double>& value, int digits = 1) {
  if (!value) return nullptr;
  return Rounded(100 * *value, digits);
}

Json Length(const std::optional<DistanceSummary>& summary, double DistanceSummary::*member) {
  if (!summary || !std::isfinite((*summary).*member)) return nullptr;
  return (*summary).*member;
}

// The figures of the surface, of the ranked AP and of discovery, under short names at the top
// level.
void AddCommonFigures(const Evaluation& e, Json* json) {
  (*json)["accuracy_m"] = Length(e.surface.accuracy, &DistanceSummary::mean);
  (*json)["accuracy_p95_m"] = Length(e.surface.accuracy, &DistanceSummary::p95);
  (*json)["completeness_m"] = Length(e.surface.completeness, &DistanceSummary::mean);
  (*json)["completeness_5cm"] = Length(e.surface.completeness, &DistanceSummary::within_radius);
  (*json)["classes"] = Json::object();
  for (const ClassEvaluation& result : e.classes) {
    if (result.ranked.ap50) (*json)["classes"][result.known.name] = JsonPercent(result.ranked.ap50);
  }
  (*json)["pred_instances"] = e.pred_instances;
  (*json)["mAP50"] = JsonPercent(e.ranked_mean.ap50);
  (*json)["mAP50_95"] = JsonPercent(e.ranked_mean.ap);
  const AnyClassScore& any = e.any_class;
  (*json)["objects_known"] = any.known.objects;
  (*json)["recall25_known"] = JsonPercent(any.known.recall25);
  (*json)["recall50_known"] = JsonPercent(any.known.recall50);
  (*json)["objects_unknown"] = any.unknown.objects;
  (*json)["discovery25_unknown"] = JsonPercent(any.unknown.recall25);
  (*json)["discovery50_unknown"] = JsonPercent(any.unknown.recall50);
  (*json)["mean_iou_known"] = Share(any.known.mean_iou, 3);
  (*json)["mean_iou_unknown"] = Share(any.unknown.mean_iou, 3);
  (*json)["fragments_per_object"] = Share(any.fragments_per_object, 2);
  (*json)["unknown_given_a_class"] = any.unknown_given_a_class;
  (*json)["structure_named_object"] = Share(any.structure_named_object, 4);
}

Json ToJson(const ScanNetAp& ap) {
  return {{"AP25", JsonPercent(ap.ap25, 2)},
          {"AP50", JsonPercent(ap.ap50, 2)},
          {"AP", JsonPercent(ap.ap, 2)}};
}

Json ToJson(const std::optional<ScanNetAp>& ap) { return ap ? ToJson(*ap) : Json(nullptr); }

Json ScanNetJson(const Evaluation& e) {
  Json json;
  json["constant_confidence"] = ToJson(e.constant_mean);
  json["real_confidence"] = ToJson(e.score_mean);
  json["any_class"] = {{"constant_confidence", ToJson(e.any_class_ap)},
                       {"real_confidence", ToJson(e.any_class_score_ap)}};
  json["classes"] = Json::object();
  for (const ClassEvaluation& result : e.classes) {
    if (result.at50.truths == 0 && result.at50.predictions == 0) continue;
    json["classes"][result.known.name] = {{"objects", result.at50.truths},
                                          {"predictions", result.at50.predictions},
                                          {"true_positives", result.at50.true_positives()},
                                          {"false_positives", result.at50.false_positives()},
                                          {"constant_confidence", ToJson(result.constant)},
                                          {"real_confidence", ToJson(result.with_score)}};
  }
  return json;
}

Json ToJson(const PanopticScore& score) {
  return {{"PQ", JsonPercent(score.pq(), 2)},         {"SQ", JsonPercent(score.sq(), 2)},
          {"RQ", JsonPercent(score.rq(), 2)},         {"true_positives", score.true_positives},
          {"false_positives", score.false_positives}, {"false_negatives", score.false_negatives}};
}

Json PanopticJson(const Evaluation& e) {
  Json json = {{"PQ", JsonPercent(e.panoptic.pq, 2)},
               {"SQ", JsonPercent(e.panoptic.sq, 2)},
               {"RQ", JsonPercent(e.panoptic.rq, 2)},
               {"any_class", ToJson(e.any_class_panoptic)},
               {"classes", Json::object()}};
  for (const ClassEvaluation& result : e.classes) {
    if (result.panoptic.pq()) json["classes"][result.known.name] = ToJson(result.panoptic);
  }
  return json;
}

Json ToJson(const ObjectFinding& finding, const std::vector<TrueObject>& truths) {
  const TrueObject& object = truths[finding.object];
  return {{"label", object.label},
          {"name", object.name},
          {"known", object.class_id != ClassId::kUnknown},
          {"points", finding.points},
          {"iou", Rounded(finding.iou, 3)},
          {"covered", Rounded(finding.covered, 3)},
          {"purity", Rounded(finding.purity, 3)},
          {"pieces", finding.pieces},
          {"found", NameOf(finding.found)},
          {"in_largest", Rounded(finding.in_largest, 3)},
          {"shared_with",
           finding.shared_with ? Json(truths[*finding.shared_with].name) : Json(nullptr)}};
}

Json ToJson(const std::optional<DistanceSummary>& summary) {
  return {{"samples", summary ? summary->samples : 0},
          {"mean_m", Length(summary, &DistanceSummary::mean)},
          {"median_m", Length(summary, &DistanceSummary::median)},
          {"p95_m", Length(summary, &DistanceSummary::p95)},
          {"within_5cm", Length(summary, &DistanceSummary::within_radius)}};
}

Json Part(int64_t part, int64_t all) {
  if (all == 0) return nullptr;
  return Rounded(static_cast<double>(part) / static_cast<double>(all), 6);
}

// Adds NAME_samples, NAME_as_free, NAME_as_occupied and NAME_as_unknown.
void AddCells(const std::string& name, const CellShares& cells, Json* json) {
  (*json)[name + "_samples"] = cells.samples;
  (*json)[name + "_as_free"] = Part(cells.free, cells.samples);
  (*json)[name + "_as_occupied"] = Part(cells.occupied, cells.samples);
  (*json)[name + "_as_unknown"] = Part(cells.unknown, cells.samples);
}

Json ToJson(const FreeSpaceEvaluation& free_space) {
  Json json = {{"cell_size_m", free_space.cell_size}};
  AddCells("truth", free_space.truth, &json);
  json["occupied_cells"] = free_space.occupied.cells;
  json["occupied_far_from_truth"] =
      Part(free_space.occupied.far_from_truth, free_space.occupied.cells);
  if (free_space.rays) {
    AddCells("free", free_space.rays->free, &json);
    AddCells("surface", free_space.rays->surface, &json);
  }
  if (free_space.analytic) {
    const FreeSpaceScore& score = *free_space.analytic;
    json["free_but_solid"] = Part(score.free_but_solid, score.free_cells);
    json["occupied_but_free"] = Part(score.occupied_but_free, score.occupied_cells);
    json["deepest_free_m"] = score.deepest_free;
  }
  return json;
}

}  // namespace

std::string EvaluationJson(const Evaluation& e) {
  Json json = {{"ground_truth", e.truth_name},
               {"format", e.truth_format},
               {"truth_points", e.truth_points},
               {"truth_objects", e.truth_objects},
               {"map_vertices", e.map_vertices}};
  AddCommonFigures(e, &json);
  json["scannet_ap"] = ScanNetJson(e);
  json["panoptic"] = PanopticJson(e);
  json["surface"] = {{"accuracy", ToJson(e.surface.accuracy)},
                     {"completeness", ToJson(e.surface.completeness)}};
  json["objects"] = Json::array();
  for (const ObjectFinding& finding : e.findings)
    json["objects"].push_back(ToJson(finding, e.truths));
  json["free_space"] = Json::array();
  for (const FreeSpaceEvaluation& free_space : e.free_space)
    json["free_space"].push_back(ToJson(free_space));
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace vismap
