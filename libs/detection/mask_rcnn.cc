#include <algorithm>
#include <cmath>

#include "detection/read_outputs.h"
#include "detection/soft_mask.h"

namespace vismap {
namespace {

constexpr int kRowLength = 7;

Result<void> CheckShapes(const Tensor& found, const Tensor& masks, size_t classes) {
  const std::vector<int>& rows = found.shape;
  const bool rows_fit = rows.size() == 4 && rows[0] == 1 && rows[1] == 1 && rows[3] == kRowLength;
  const bool masks_fit = masks.shape.size() == 4 && rows_fit && masks.shape[0] >= rows[2] &&
                         masks.shape[1] == static_cast<int>(classes) && masks.shape[2] > 0 &&
                         masks.shape[3] > 0;
  if (rows_fit && (masks_fit || rows[2] == 0)) return {};
  return Fail("expected the outputs of Mask R-CNN, 1x1xNx7 and Nx" + std::to_string(classes) +
              "xHEIGHTxWIDTH, found " + ShapeText(found.shape) + " and " + ShapeText(masks.shape));
}

/// The rows with a known class and enough score, with boxes in image pixels; `source` = row.
std::vector<Candidate> Candidates(const Tensor& found, int image_width, int image_height,
                                  const ClassTable& classes, float min_score) {
  const auto width = static_cast<float>(image_width), height = static_cast<float>(image_height);
  std::vector<Candidate> candidates;
  for (int row = 0; row < found.shape[2]; ++row) {
    const float* at = &found.values[static_cast<size_t>(row) * kRowLength];
    const bool known = at[1] >= 0 && at[1] < static_cast<float>(classes.size());
    if (!known || !(at[2] >= min_score) || !std::isfinite(at[3] + at[4] + at[5] + at[6])) continue;
    const auto index = static_cast<size_t>(at[1]);
    if (classes[index] == ClassId::kUnknown) continue;  // a class to drop
    candidates.push_back({static_cast<int>(index),
                          std::min(at[2], 1.0f),
                          {at[3] * width, at[4] * height, at[5] * width, at[6] * height},
                          row});
  }
  return candidates;
}

/// The mask of a candidate, placed over its box.
SoftMask OverBox(const Tensor& masks, const Candidate& candidate) {
  SoftMask soft;
  soft.width = masks.shape[3];
  soft.height = masks.shape[2];
  const size_t cells = static_cast<size_t>(soft.width) * static_cast<size_t>(soft.height);
  const size_t slice = static_cast<size_t>(candidate.source) * static_cast<size_t>(masks.shape[1]) +
                       static_cast<size_t>(candidate.class_index);
  soft.values = std::span(masks.values).subspan(slice * cells, cells);
  const Box& box = candidate.box;
  soft.scale_u = soft.width / std::max(1e-6, static_cast<double>(box.u1) - box.u0);
  soft.scale_v = soft.height / std::max(1e-6, static_cast<double>(box.v1) - box.v0);
  soft.offset_u = -box.u0 * soft.scale_u;
  soft.offset_v = -box.v0 * soft.scale_v;
  return soft;
}

}  // namespace

Result<std::vector<Detection>> MaskRcnnDetections(const Tensor& found, const Tensor& masks,
                                                  int image_width, int image_height,
                                                  const ClassTable& classes,
                                                  const DnnDetectorOptions& options) {
  if (const auto checked = CheckShapes(found, masks, classes.size()); !checked)
    return tl::unexpected(checked.error());
  std::vector<Detection> detections;
  for (const Candidate& candidate :
       SuppressOverlaps(Candidates(found, image_width, image_height, classes,
                                   static_cast<float>(options.min_score)),
                        static_cast<float>(options.nms_iou), options.max_detections)) {
    Mask mask = MaskFromSoft(OverBox(masks, candidate), candidate.box, image_width, image_height,
                             static_cast<float>(options.mask_threshold));
    if (mask.inside.empty()) continue;
    detections.push_back(
        {classes[static_cast<size_t>(candidate.class_index)], candidate.score, std::move(mask)});
  }
  return detections;
}

}  // namespace vismap
