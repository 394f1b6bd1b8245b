#include "segmentation/segment_frame.h"

#include <utility>

#include "geometry/compute_surface.h"
#include "segmentation/refine.h"
#include "segmentation/segment_depth.h"

namespace vismap {

SegmentedFrame SegmentFrame(RgbdFrame frame, const DetectionSet* detections,
                            const SegmentationStageOptions& options) {
  const SurfaceMap surface = ComputeSurface(frame.depth, frame.header.camera, options.surface);
  SegmentImage image = SegmentDepth(surface, frame.header.camera, options.segmentation);
  return RefineWithDetections(std::move(frame), std::move(image), detections, options.refine);
}

}  // namespace vismap
