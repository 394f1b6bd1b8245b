#include <cmath>

#include "detection/read_outputs.h"
#include "detection/soft_mask.h"
#include "detection/yolo_head.h"

namespace vismap {
namespace {

/// sigmoid(coefficients of a row x prototypes): a grid over the whole input.
std::vector<float> MaskOfRow(const YoloLayout& layout, const YoloOutputs& outputs, int row) {
  const Tensor& prototypes = outputs.prototypes;
  const size_t cells = prototypes.values.size() / static_cast<size_t>(layout.coefficients);
  const int first = layout.features() - layout.coefficients;
  std::vector<float> values(cells, 0.0f);
  for (int k = 0; k < layout.coefficients; ++k) {
    const float coefficient = YoloFeature(layout, outputs.head, first + k, row);
    const float* prototype = &prototypes.values[static_cast<size_t>(k) * cells];
    for (size_t i = 0; i < cells; ++i) values[i] += coefficient * prototype[i];
  }
  for (float& value : values) value = 1 / (1 + std::exp(-value));
  return values;
}

/// The grid, placed over the image.
SoftMask OverImage(const std::vector<float>& values, const Tensor& prototypes,
                   const Letterbox& letterbox) {
  SoftMask soft;
  soft.width = prototypes.shape[3];
  soft.height = prototypes.shape[2];
  soft.values = values;
  soft.scale_u = letterbox.scale_u() * soft.width / letterbox.input_width;
  soft.scale_v = letterbox.scale_v() * soft.height / letterbox.input_height;
  return soft;
}

}  // namespace

Result<std::vector<Detection>> YoloDetections(std::vector<Tensor> outputs,
                                              const Letterbox& letterbox, const ClassTable& classes,
                                              const DnnDetectorOptions& options) {
  const Result<YoloOutputs> sorted = SortYoloOutputs(std::move(outputs));
  if (!sorted) return tl::unexpected(sorted.error());
  const Result<YoloLayout> layout = FindYoloLayout(*sorted, static_cast<int>(classes.size()));
  if (!layout) return tl::unexpected(layout.error());
  std::vector<Candidate> candidates =
      YoloCandidates(*layout, sorted->head, static_cast<float>(options.min_score));
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return classes[static_cast<size_t>(candidate.class_index)] == ClassId::kUnknown;
  });
  std::vector<Detection> detections;
  for (const Candidate& candidate : SuppressOverlaps(
           std::move(candidates), static_cast<float>(options.nms_iou), options.max_detections)) {
    const std::vector<float> values = MaskOfRow(*layout, *sorted, candidate.source);
    Mask mask = MaskFromSoft(OverImage(values, sorted->prototypes, letterbox),
                             ToImage(letterbox, candidate.box), letterbox.image_width,
                             letterbox.image_height, static_cast<float>(options.mask_threshold));
    if (mask.inside.empty()) continue;
    detections.push_back(
        {classes[static_cast<size_t>(candidate.class_index)], candidate.score, std::move(mask)});
  }
  return detections;
}

}  // namespace vismap
