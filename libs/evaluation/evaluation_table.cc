#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "evaluation/report.h"

namespace vismap {
namespace {

constexpr const char* kNothing = "-";

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::string Percent(const std::optional<double>& share) {
  return share ? Format("%.1f", 100 * *share) : kNothing;
}

// A table with a column per class, and a last column for the mean.
class ClassTable {
 public:
  explicit ClassTable(const Evaluation& evaluation) : evaluation_(evaluation) {
    AddRow(
        "", [](const ClassEvaluation& result) { return result.known.name; }, "mean");
  }

  void AddRow(const std::string& title,
              const std::function<std::string(const ClassEvaluation&)>& cell,
              const std::string& mean) {
    text_ += Format("%-23s", title.c_str());
    for (const ClassEvaluation& result : evaluation_.classes) {
      const int width = std::max(9, static_cast<int>(result.known.name.size()) + 2);
      text_ += Format("%*s", width, cell(result).c_str());
    }
    text_ += Format("%8s", mean.c_str());
    text_.erase(text_.find_last_not_of(' ') + 1);
    text_ += "\n";
  }

  void AddScores(const std::string& title,
                 const std::function<std::optional<double>(const ClassEvaluation&)>& score,
                 const std::optional<double>& mean) {
    AddRow(
        title, [&](const ClassEvaluation& result) { return Percent(score(result)); },
        Percent(mean));
  }

  const std::string& text() const { return text_; }

 private:
  const Evaluation& evaluation_;
  std::string text_;
};

std::string Counts(const ClassEvaluation& result) {
  const ScanNetEvidence& at50 = result.at50;
  if (at50.truths == 0 && at50.predictions == 0) return kNothing;
  return Format("%d/%d/%d", at50.true_positives(), at50.truths, at50.predictions);
}

std::string Classes(const Evaluation& e) {
  ClassTable table(e);
  table.AddScores(
      "AP50, no ranking", [](const auto& r) { return r.constant.ap50; }, e.constant_mean.ap50);
  if (e.score_mean) {
    table.AddScores(
        "AP50, by score", [](const auto& r) { return r.with_score->ap50; }, e.score_mean->ap50);
    table.AddScores(
        "AP25, by score", [](const auto& r) { return r.with_score->ap25; }, e.score_mean->ap25);
    table.AddScores(
        "AP50:95, by score", [](const auto& r) { return r.with_score->ap; }, e.score_mean->ap);
  } else {
    table.AddScores(
        "AP25, no ranking", [](const auto& r) { return r.constant.ap25; }, e.constant_mean.ap25);
    table.AddScores(
        "AP50:95, no ranking", [](const auto& r) { return r.constant.ap; }, e.constant_mean.ap);
  }
  table.AddScores(
      "AP50, void counts", [](const auto& r) { return r.ranked.ap50; }, e.ranked_mean.ap50);
  table.AddScores(
      "PQ", [](const auto& r) { return r.panoptic.pq(); }, e.panoptic.pq);
  table.AddRow("found/objects/predicted", Counts, "");
  return table.text();
}

std::string Surface(const char* title, const std::optional<DistanceSummary>& summary) {
  if (!summary) return Format("%-24s nothing to measure\n", title);
  return Format("%-24s mean %.1f mm, median %.1f mm, 95 %% %.1f mm, within 5 cm %.1f %%\n", title,
                summary->mean * 1e3, summary->median * 1e3, summary->p95 * 1e3,
                summary->within_radius * 100);
}

std::string DiscoveryLine(const char* title, const DiscoveryScore& score) {
  return Format("%-24s %d; found at IoU 0.5 %s %%, at 0.25 %s %%; mean IoU %s %%\n", title,
                score.objects, Percent(score.recall50).c_str(), Percent(score.recall25).c_str(),
                Percent(score.mean_iou).c_str());
}

std::string AnyClassAp(const char* title, const ScanNetAp& ap) {
  return Format("%-24s AP25 %s, AP50 %s, AP50:95 %s, %s\n", "  as ScanNet200",
                Percent(ap.ap25).c_str(), Percent(ap.ap50).c_str(), Percent(ap.ap).c_str(), title);
}

std::string DiscoveryLines(const Evaluation& e) {
  const AnyClassScore& any = e.any_class;
  const PanopticScore& panoptic = e.any_class_panoptic;
  return DiscoveryLine("objects of COCO classes", any.known) +
         DiscoveryLine("unknown objects", any.unknown) +
         Format(
             "%-24s %s per object; unknown objects given a class %d; structure inside "
             "objects %s %%\n",
             "fragments",
             any.fragments_per_object ? Format("%.2f", *any.fragments_per_object).c_str()
                                      : kNothing,
             any.unknown_given_a_class, Percent(any.structure_named_object).c_str()) +
         Format("%-24s PQ %s, SQ %s, RQ %s\n", "objects of any class",
                Percent(panoptic.pq()).c_str(), Percent(panoptic.sq()).c_str(),
                Percent(panoptic.rq()).c_str()) +
         AnyClassAp("no ranking", e.any_class_ap) +
         (e.any_class_score_ap ? AnyClassAp("by score", *e.any_class_score_ap) : "");
}

double PercentOf(int64_t part, int64_t all) {
  return all == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(all);
}

std::string Cells(const CellShares& cells) {
  return Format("%.2f %% free, %.1f %% occupied, %.1f %% unknown",
                PercentOf(cells.free, cells.samples), PercentOf(cells.occupied, cells.samples),
                PercentOf(cells.unknown, cells.samples));
}

std::string FreeSpace(const FreeSpaceEvaluation& space) {
  std::string text = Format("cells of %-15s ", Format("%.3g m", space.cell_size).c_str()) +
                     "true surface: " + Cells(space.truth) +
                     Format("; occupied cells far from it %.1f %%\n",
                            PercentOf(space.occupied.far_from_truth, space.occupied.cells));
  if (space.rays)
    text += Format("%-24s ", "") + "measured free space: " + Cells(space.rays->free) + "\n" +
            Format("%-24s ", "") + "measured surface: " + Cells(space.rays->surface) + "\n";
  if (space.analytic) {
    text += Format(
        "%-24s free cells in solids %.4f %%, deepest %.1f mm; occupied in the open "
        "%.2f %%\n",
        "", PercentOf(space.analytic->free_but_solid, space.analytic->free_cells),
        space.analytic->deepest_free * 1e3,
        PercentOf(space.analytic->occupied_but_free, space.analytic->occupied_cells));
  }
  return text;
}

// The name of a true object with its label, which is unique: "chair 12".
std::string TitleOf(const TrueObject& object) {
  return Format("%.21s %u", object.name.c_str(), object.label);
}

std::string FindingLine(const ObjectFinding& finding, const std::vector<TrueObject>& truths) {
  const TrueObject& object = truths[finding.object];
  std::string line =
      Format("%-28s%-8s%8lld%7.1f%9.1f%8.1f%8d  %-10s", TitleOf(object).c_str(),
             object.class_id == ClassId::kUnknown ? "unknown" : "known",
             static_cast<long long>(finding.points), 100 * finding.iou, 100 * finding.covered,
             100 * finding.purity, finding.pieces, NameOf(finding.found).c_str());
  if (finding.found == FoundAs::kSwallowed) {
    line += Format("%.1f %% of it in a group of %s", 100 * finding.in_largest,
                   finding.shared_with ? TitleOf(truths[*finding.shared_with]).c_str()
                                       : "surface without an object");
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

// How many objects became what: "12 found, 3 broken, 5 swallowed, 1 missing".
std::string CountFindings(const std::vector<ObjectFinding>& findings) {
  std::string text;
  for (const FoundAs found :
       {FoundAs::kFound, FoundAs::kBroken, FoundAs::kSwallowed, FoundAs::kMissing}) {
    const auto count = std::count_if(findings.begin(), findings.end(),
                                     [&](const ObjectFinding& f) { return f.found == found; });
    text +=
        Format("%s%d %s", text.empty() ? "" : ", ", static_cast<int>(count), NameOf(found).c_str());
  }
  return text;
}

}  // namespace

std::string FindingsTable(const Evaluation& e) {
  std::vector<ObjectFinding> worst_first = e.findings;
  std::stable_sort(worst_first.begin(), worst_first.end(),
                   [](const ObjectFinding& a, const ObjectFinding& b) { return a.iou < b.iou; });
  std::string text = Format("%-28s%-8s%8s%7s%9s%8s%8s\n", "object", "class", "points", "IoU %",
                            "covered", "purity", "pieces");
  for (const ObjectFinding& finding : worst_first) text += FindingLine(finding, e.truths);
  return text + CountFindings(e.findings) + "\n";
}

std::string EvaluationTable(const Evaluation& e) {
  std::string text =
      Format("%s (%s): %zu objects on %zu points; map: %d instances with a class, %zu vertices\n",
             e.truth_name.c_str(), e.truth_format.c_str(), e.truth_objects, e.truth_points,
             e.pred_instances, e.map_vertices);
  text += Classes(e) + DiscoveryLines(e) + Surface("accuracy", e.surface.accuracy) +
          Surface("completeness", e.surface.completeness);
  for (const FreeSpaceEvaluation& space : e.free_space) text += FreeSpace(space);
  return text;
}

}  // namespace vismap
