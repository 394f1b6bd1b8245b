#pragma once

#include <functional>

#include "base/stopwatch.h"
#include "segmentation/segment_frame.h"
#include "session/map_session.h"

namespace vismap {

/// What mapping a frame gave.
struct MappedFrame {
  FrameAssociation association;  ///< which segments and instances of the map the frame shows
  MapDelta delta;                ///< what the frame changed in the map
};

/// The way of one frame into the map (Grinvald 2019, Sec. III). `detections` = nullptr: no detector
/// has looked at the frame. `watch` measures the stages "segmentation", "association" and
/// "integration". `on_segmented` sees the frame with its segments. Throws when the map of the
/// session contains the frame already.
MappedFrame MapFrame(RgbdFrame frame, const DetectionSet* detections,
                     const SegmentationStageOptions& options, MapSession* session,
                     const Stopwatch& watch = {},
                     const std::function<void(const SegmentedFrame&)>& on_segmented = {});

/// The same for a frame that another process has segmented.
MappedFrame MapFrame(const SegmentedFrame& frame, MapSession* session, const Stopwatch& watch = {});

}  // namespace vismap
