#pragma once

#include <vector>

#include "base/result.h"
#include "detection/box.h"
#include "detection/tensor.h"

namespace vismap {

/// The layout of the output of a YOLO segmentation head. A row has the features
///   v8, v11:  cx, cy, w, h, score of each class, mask coefficients
///   v5:       cx, cy, w, h, objectness, score of each class, mask coefficients
/// There is a row for each place where an object may be. Boxes are in input pixels, scores in [0,
/// 1].
struct YoloLayout {
  int classes = 0;
  int coefficients = 0;
  int rows = 0;
  bool objectness = false;     ///< whether rows have an objectness (v5)
  bool features_first = true;  ///< 1 x features x rows (v8), else 1 x rows x features
  int features() const { return 4 + (objectness ? 1 : 0) + classes + coefficients; }
};

/// The two outputs of a YOLO segmentation network.
struct YoloOutputs {
  Tensor head;        ///< three dimensions
  Tensor prototypes;  ///< 1 x coefficients x height x width
};

/// Finds the two outputs by their shapes. Fails, with the shapes found, unless there is one of each
/// kind.
Result<YoloOutputs> SortYoloOutputs(std::vector<Tensor> outputs);

/// The layout that fits the shapes and the number of classes. If the number of classes is one too
/// small, a v8 head is taken for a v5 head, because the shapes are the same. Fails with the shapes
/// expected and found.
Result<YoloLayout> FindYoloLayout(const YoloOutputs& outputs, int classes);

/// The value of a feature in a row of the head.
float YoloFeature(const YoloLayout& layout, const Tensor& head, int feature, int row);

/// The best class of every row whose score is at least `min_score`, with the box in input pixels
/// and `source` = row. Rows with NaN or infinite numbers are left out.
std::vector<Candidate> YoloCandidates(const YoloLayout& layout, const Tensor& head,
                                      float min_score);

}  // namespace vismap
