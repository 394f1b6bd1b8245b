#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "segmentation/segmented_frame.h"

namespace vismap {

/// The JSON of a picture (kind 2, see procs/README.md) of a camera with `width` x `height` pixels:
/// its segments over a sampled image of at most 320 columns, with their detections. `image` =
/// nullptr: the segments are not known. `problem`: what is missing, a sentence; "" = nothing.
std::string PictureText(int camera_id, int64_t utime, int width, int height,
                        const SegmentImage* image, std::span<const FrameSegment> segments,
                        const std::string& problem);

/// The message of kind 2 for a frame that was segmented here.
std::vector<uint8_t> MakePicture(const SegmentedFrame& frame);

}  // namespace vismap
