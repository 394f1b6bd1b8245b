#include "session/map_frame.h"

#include <utility>

namespace vismap {

MappedFrame MapFrame(RgbdFrame frame, const DetectionSet* detections,
                     const SegmentationStageOptions& options, MapSession* session,
                     const Stopwatch& watch,
                     const std::function<void(const SegmentedFrame&)>& on_segmented) {
  // Sec. III-A, geometric segmentation: the depth image is cut into regions r_i.
  // Sec. III-B, refinement: each region gets the detection o_i and the class c_i of the mask that
  // covers most of it.
  const SegmentedFrame segmented = watch.Measure(
      "segmentation", [&] { return SegmentFrame(std::move(frame), detections, options); });
  if (on_segmented) on_segmented(segmented);
  return MapFrame(segmented, session, watch);
}

MappedFrame MapFrame(const SegmentedFrame& frame, MapSession* session, const Stopwatch& watch) {
  // Sec. III-C, data association: each segment s_i gets a persistent label l = L_t(s_i), each
  // detection o_i a persistent instance I_t(o_i). Changes nothing in the map.
  FrameAssociation association =
      watch.Measure("association", [&] { return session->Associate(frame); });
  // Sec. III-D, integration: distances, colours and label votes of the voxels in view, the counts
  // Phi(l, o) and Psi(l, c); then labels that turned out to be one piece of surface are merged.
  MapDelta delta =
      watch.Measure("integration", [&] { return session->Integrate(frame, association); });
  return {std::move(association), std::move(delta)};
}

}  // namespace vismap
