#include "segmentation/segment_frame.h"

#include <utility>

#include "geometry/compute_surface.h"
#include "geometry/prepare_depth.h"
#include "segmentation/leave_out.h"
#include "segmentation/refine.h"
#include "segmentation/segment_depth.h"

namespace vismap {

SegmentedFrame SegmentFrame(RgbdFrame frame, const DetectionSet* detections,
                            const SegmentationStageOptions& options) {
  DetectionSet rest;
  if (detections != nullptr && !options.refine.leave_out_classes.empty()) {
    LeaveOut(*detections, options.refine, &frame);
    rest = WithoutLeftOut(*detections, options.refine);
    detections = &rest;
  }
  PrepareDepth(PrepareDepthOptionsOf(options.surface), &frame);
  const SurfaceMap surface = ComputeSurface(frame.depth, frame.header.camera, options.surface);
  SegmentImage image = SegmentDepth(surface, frame.header.camera, options.segmentation);
  return RefineWithDetections(std::move(frame), std::move(image), detections, options.refine);
}

}  // namespace vismap
