#include "detection/yolo_head.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace vismap {
namespace {

constexpr char kExpectedOutputs[] =
    "expected a YOLO segmentation head with the outputs 1xFEATURESxROWS and "
    "1xCOEFFICIENTSxHEIGHTxWIDTH";

bool IsHead(const Tensor& tensor) { return tensor.shape.size() == 3 && tensor.shape[0] == 1; }
bool IsPrototypes(const Tensor& tensor) {
  return tensor.shape.size() == 4 && tensor.shape[0] == 1 && !tensor.values.empty();
}

/// The class with the highest score in a row, without its box.
Candidate BestOfRow(const YoloLayout& layout, const Tensor& head, int row) {
  const int first_class = layout.objectness ? 5 : 4;
  Candidate best{.class_index = 0, .score = -1, .box = {}, .source = row};
  for (int index = 0; index < layout.classes; ++index) {
    const float score = YoloFeature(layout, head, first_class + index, row);
    if (score > best.score) {
      best.score = score;
      best.class_index = index;
    }
  }
  if (layout.objectness) best.score *= YoloFeature(layout, head, 4, row);
  return best;
}

}  // namespace

Result<YoloOutputs> SortYoloOutputs(std::vector<Tensor> outputs) {
  const std::string found = ShapesText(outputs);
  YoloOutputs sorted;
  for (Tensor& output : outputs) {
    Tensor* place = IsHead(output)         ? &sorted.head
                    : IsPrototypes(output) ? &sorted.prototypes
                                           : nullptr;
    // Exports of YOLOv5 may also have the heads of its three scales, with five dimensions.
    if (place == nullptr) continue;
    if (!place->shape.empty()) return Fail(std::string(kExpectedOutputs) + ", found " + found);
    *place = std::move(output);
  }
  if (sorted.head.shape.empty() || sorted.prototypes.shape.empty()) {
    return Fail(std::string(kExpectedOutputs) + ", found " + found);
  }
  return sorted;
}

Result<YoloLayout> FindYoloLayout(const YoloOutputs& outputs, int classes) {
  const int coefficients = outputs.prototypes.shape[1];
  const int first = outputs.head.shape[1], second = outputs.head.shape[2];
  for (const bool objectness : {false, true}) {
    // If both dimensions fit, the usual order of the family is used.
    for (const bool features_first : {!objectness, objectness}) {
      YoloLayout layout{classes, coefficients, features_first ? second : first, objectness,
                        features_first};
      if (layout.features() == (features_first ? first : second)) return layout;
    }
  }
  const int expected = 4 + classes + coefficients;
  return Fail("the head is " + ShapeText(outputs.head.shape) + ", expected one side of " +
              std::to_string(expected) + " (v8, v11) or " + std::to_string(expected + 1) +
              " (v5): box, " + std::to_string(classes) + " classes, " +
              std::to_string(coefficients) +
              " mask coefficients; for a model with other classes, set class_names");
}

float YoloFeature(const YoloLayout& layout, const Tensor& head, int feature, int row) {
  const size_t index = layout.features_first
                           ? static_cast<size_t>(feature) * static_cast<size_t>(layout.rows) +
                                 static_cast<size_t>(row)
                           : static_cast<size_t>(row) * static_cast<size_t>(layout.features()) +
                                 static_cast<size_t>(feature);
  return head.values[index];
}

std::vector<Candidate> YoloCandidates(const YoloLayout& layout, const Tensor& head,
                                      float min_score) {
  std::vector<Candidate> candidates;
  for (int row = 0; row < layout.rows; ++row) {
    Candidate candidate = BestOfRow(layout, head, row);
    if (!(candidate.score >= min_score)) continue;
    candidate.score = std::min(candidate.score, 1.0f);
    const float u = YoloFeature(layout, head, 0, row), v = YoloFeature(layout, head, 1, row);
    const float w = YoloFeature(layout, head, 2, row), h = YoloFeature(layout, head, 3, row);
    if (!std::isfinite(u + v + w + h)) continue;
    candidate.box = {u - w / 2, v - h / 2, u + w / 2, v + h / 2};
    candidates.push_back(candidate);
  }
  return candidates;
}

}  // namespace vismap
