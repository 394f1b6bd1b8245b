#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace vismap::testing_support {

/// ScanNet's evaluate_semantic_instance.py (and that of ScanNet200, which differs in its classes
/// only), rewritten line by line for one class and one scene, as a twin of scannet_ap.h that shares
/// no code with it. It works on the points themselves and is slow.
class ScanNetScript {
 public:
  /// `objects[i]` = the true object of point i, -1 = void; `groups[i]` = the predicted one, -1 =
  /// none. Objects and predictions are numbered 0, 1, ...; `confidence` is that of each prediction.
  ScanNetScript(const std::vector<int>& objects, const std::vector<int>& groups,
                const std::vector<double>& confidence, int min_region_size)
      : min_region_size_(min_region_size) {
    const int object_count = 1 + *std::max_element(objects.begin(), objects.end());
    for (int object = 0; object < object_count; ++object)
      gt_.push_back({static_cast<double>(std::count(objects.begin(), objects.end(), object)), {}});
    for (size_t p = 0; p < confidence.size(); ++p)
      AssignPrediction(objects, groups, static_cast<int>(p), confidence[p]);
  }

  /// evaluate_matches for one overlap; NaN without objects.
  double Ap(double overlap_th) const {
    std::vector<double> y_true, y_score;
    int hard_false_negatives = 0;
    Match(overlap_th, &y_true, &y_score, &hard_false_negatives);
    const bool has_gt = std::any_of(
        gt_.begin(), gt_.end(), [&](const Gt& gt) { return gt.vert_count >= min_region_size_; });
    if (!has_gt) return std::numeric_limits<double>::quiet_NaN();
    if (preds_.empty()) return 0;
    return Area(y_true, y_score, hard_false_negatives);
  }

  /// compute_averages: the mean over np.arange(0.5, 0.95, 0.05), which ends at 0.9.
  double MeanAp() const {
    double sum = 0;
    for (int i = 0; i < 9; ++i) sum += Ap(0.5 + 0.05 * i);
    return sum / 9;
  }

 private:
  struct Match1 {
    size_t index = 0;
    double intersection = 0;
  };
  struct Gt {
    double vert_count = 0;
    std::vector<Match1> matched_pred;
  };
  struct Pred {
    double vert_count = 0, confidence = 0, void_intersection = 0;
    std::vector<Match1> matched_gt;
  };

  void AssignPrediction(const std::vector<int>& objects, const std::vector<int>& groups, int group,
                        double confidence) {
    const auto num = static_cast<double>(std::count(groups.begin(), groups.end(), group));
    if (num < min_region_size_) return;  // skip if empty or too small
    Pred pred{num, confidence, 0, {}};
    for (int object = -1; object < static_cast<int>(gt_.size()); ++object) {
      double intersection = 0;
      for (size_t i = 0; i < objects.size(); ++i)
        intersection += objects[i] == object && groups[i] == group;
      if (object == -1) {
        pred.void_intersection = intersection;
      } else if (intersection > 0) {
        gt_[static_cast<size_t>(object)].matched_pred.push_back({preds_.size(), intersection});
        pred.matched_gt.push_back({static_cast<size_t>(object), intersection});
      }
    }
    preds_.push_back(pred);
  }

  static double Overlap(double gt, double pred, double intersection) {
    return intersection / (gt + pred - intersection);
  }

  void Match(double overlap_th, std::vector<double>* y_true, std::vector<double>* y_score,
             int* hard_false_negatives) const {
    std::vector<bool> pred_visited(preds_.size(), false);
    for (const Gt& gt : gt_) {
      if (gt.vert_count < min_region_size_) continue;
      bool found_match = false;
      double cur_score = 0;
      for (const Match1& match : gt.matched_pred) {
        const Pred& pred = preds_[match.index];
        if (pred_visited[match.index] ||
            Overlap(gt.vert_count, pred.vert_count, match.intersection) <= overlap_th)
          continue;
        if (found_match) {  // the lower score is a false positive
          y_true->push_back(0);
          y_score->push_back(std::min(cur_score, pred.confidence));
          cur_score = std::max(cur_score, pred.confidence);
        } else {
          found_match = true;
          cur_score = pred.confidence;
          pred_visited[match.index] = true;
        }
      }
      if (found_match) {
        y_true->push_back(1);
        y_score->push_back(cur_score);
      } else {
        ++*hard_false_negatives;
      }
    }
    for (const Pred& pred : preds_) {
      bool found_gt = false;
      double num_ignore = pred.void_intersection;
      for (const Match1& match : pred.matched_gt) {
        const double vert_count = gt_[match.index].vert_count;
        if (Overlap(vert_count, pred.vert_count, match.intersection) > overlap_th) found_gt = true;
        if (vert_count < min_region_size_) num_ignore += match.intersection;
      }
      if (found_gt || num_ignore / pred.vert_count > overlap_th) continue;
      y_true->push_back(0);
      y_score->push_back(pred.confidence);
    }
  }

  // The area under the curve; names as in the script.
  static double Area(const std::vector<double>& y_true, const std::vector<double>& y_score,
                     int hard_false_negatives) {
    std::vector<size_t> score_arg_sort(y_score.size());
    std::iota(score_arg_sort.begin(), score_arg_sort.end(), size_t{0});
    std::stable_sort(score_arg_sort.begin(), score_arg_sort.end(),
                     [&](size_t a, size_t b) { return y_score[a] < y_score[b]; });
    std::vector<double> cumsum, precision, recall;
    std::vector<size_t> unique_indices;
    double sum = 0;
    for (size_t i = 0; i < score_arg_sort.size(); ++i) {
      if (i == 0 || y_score[score_arg_sort[i]] != y_score[score_arg_sort[i - 1]])
        unique_indices.push_back(i);
      cumsum.push_back(sum += y_true[score_arg_sort[i]]);
    }
    for (const size_t index : unique_indices) {
      const double before = index == 0 ? 0 : cumsum[index - 1];
      const double tp = sum - before, fn = before + hard_false_negatives;
      precision.push_back(tp / static_cast<double>(y_score.size() - index));
      recall.push_back(tp + fn == 0 ? 0 : tp / (tp + fn));
    }
    precision.push_back(1);
    recall.push_back(0);
    // np.convolve([recall[0], *recall, 0], [-0.5, 0, 0.5], 'valid')
    std::vector<double> conv{recall.front()};
    conv.insert(conv.end(), recall.begin(), recall.end());
    conv.push_back(0);
    double ap_current = 0;
    for (size_t i = 0; i < precision.size(); ++i)
      ap_current += precision[i] * 0.5 * (conv[i] - conv[i + 2]);
    return ap_current;
  }

  double min_region_size_;
  std::vector<Gt> gt_;
  std::vector<Pred> preds_;
};

}  // namespace vismap::testing_support
