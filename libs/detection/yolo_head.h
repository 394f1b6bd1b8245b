#pragma once

#include <vector>

#include "base/result.h"
#include "detection/box.h"
#include "detection/tensor.h"

namespace vismap {

/// Where things stand in the output of a YOLO segmentation head: rows of
///   v8, v11:  cx, cy, w, h, score of each class, mask coefficients
///   v5:       cx, cy, w, h, objectness, score of each class, mask coefficients
/// one for each place where an object may be. Boxes are in input pixels, scores in [0, 1].
struct YoloLayout {
  int classes = 0;
  int coefficients = 0;
  int rows = 0;
  bool objectness = false;     ///< v5
  bool features_first = true;  ///< stored 1 x features x rows (v8) instead of 1 x rows x features
  int features() const { return 4 + (objectness ? 1 : 0) + classes + coefficients; }
};

/// The two outputs of a YOLO segmentation network, told apart by their shapes.
struct YoloOutputs {
  Tensor head;        ///< three dimensions
  Tensor prototypes;  ///< 1 x coefficients x height x width
};

/// Fails, with the shapes found, unless there is one output of each kind.
Result<YoloOutputs> SortYoloOutputs(std::vector<Tensor> outputs);

/// The layout that fits the shapes and the number of classes; one class too few makes v8 look like
/// v5, which the shapes cannot tell. Fails with the shapes expected and
/// found.
Result<YoloLayout> FindYoloLayout(const YoloOutputs& outputs, int classes);

/// Feature `feature` of row `row`.
float YoloFeature(const YoloLayout& layout, const Tensor& head, int feature, int row);

/// The best class of every row where it reaches `min_score`; the box in input pixels, `source` =
/// row. Rows with numbers that are none are left out.
std::vector<Candidate> YoloCandidates(const YoloLayout& layout, const Tensor& head,
                                      float min_score);

}  // namespace vismap
