#include "segmentation/leave_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismap {
namespace {

bool IsLeftOut(ClassId class_id, const RefineOptions& options) {
  return std::find(options.leave_out_classes.begin(), options.leave_out_classes.end(), class_id) !=
         options.leave_out_classes.end();
}

/// Sets the pixels of all masks to leave out to 1. Returns whether there is such a pixel.
bool PaintMasks(const DetectionSet& set, const RefineOptions& options, Image<uint8_t>* image) {
  bool any = false;
  for (const Detection& detection : set.detections) {
    if (!IsLeftOut(detection.class_id, options) || detection.score < options.min_score) continue;
    const Mask& mask = detection.mask;
    for (int y = 0; y < mask.inside.height(); ++y) {
      for (int x = 0; x < mask.inside.width(); ++x) {
        const int v = y + mask.v0, u = x + mask.u0;
        if (mask.inside(y, x) == 0 || !image->Contains(v, u)) continue;
        (*image)(v, u) = 1;
        any = true;
      }
    }
  }
  return any;
}

/// Grows the ones of a line of `count` pixels, `stride` apart, by `radius` to both sides.
void GrowLine(uint8_t* line, int count, int stride, int radius) {
  int reach = 0;  // how many pixels are still to be set after the last one of the mask
  std::vector<uint8_t> grown(static_cast<size_t>(count));
  const auto pass = [&](int i) {
    if (line[i * stride] != 0) reach = radius + 1;
    if (reach > 0) grown[static_cast<size_t>(i)] = 1;
    reach = std::max(reach - 1, 0);
  };
  for (int i = 0; i < count; ++i) pass(i);
  reach = 0;
  for (int i = count - 1; i >= 0; --i) pass(i);
  for (int i = 0; i < count; ++i) line[i * stride] = grown[static_cast<size_t>(i)];
}

/// Dilates by a square of side 2 radius + 1: first the rows, then the columns.
void Grow(int radius, Image<uint8_t>* image) {
  if (radius <= 0) return;
  for (int v = 0; v < image->height(); ++v) GrowLine(image->row(v), image->width(), 1, radius);
  for (int u = 0; u < image->width(); ++u)
    GrowLine(image->row(0) + u, image->height(), image->width(), radius);
}

}  // namespace

int64_t LeaveOut(const DetectionSet& detections, const RefineOptions& options, RgbdFrame* frame) {
  if (options.leave_out_classes.empty()) return 0;
  Image<uint8_t> out(frame->depth.width(), frame->depth.height());
  if (!PaintMasks(detections, options, &out)) return 0;
  const double scale = frame->depth.width() / 640.0;
  Grow(static_cast<int>(std::lround(options.leave_out_margin_px * scale)), &out);
  int64_t removed = 0;
  for (size_t i = 0; i < frame->depth.size(); ++i) {
    float& depth = frame->depth.data()[i];
    if (out.data()[i] == 0 || std::isnan(depth)) continue;
    depth = std::numeric_limits<float>::quiet_NaN();
    ++removed;
  }
  return removed;
}

DetectionSet WithoutLeftOut(const DetectionSet& detections, const RefineOptions& options) {
  DetectionSet rest = detections;
  std::erase_if(rest.detections,
                [&](const Detection& detection) { return IsLeftOut(detection.class_id, options); });
  return rest;
}

}  // namespace vismap
