#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/class_names.h"
#include "geometry/frame.h"
#include "mcap/foxglove_file.h"
#include "segmentation/detections.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

// Frames of a camera as messages of Foxglove. `frame_id` names a frame of reference. Pixels of ours
// have their centres at whole numbers; Foxglove counts from the corner of the image, and so
// positions in annotations are larger by 0.5.

/// The colour image of a frame, which must have one: JPEG and PNG byte for byte as
/// foxglove.CompressedImage, raw pixels as foxglove.RawImage.
FoxgloveMessage ColorMessage(const SensorFrame& frame, const std::string& frame_id);

/// The depth image as foxglove.RawImage in whole millimetres (16UC1); 0 = no return, or beyond
/// 65.534 m.
FoxgloveMessage DepthMessage(const SensorFrame& frame, const std::string& frame_id);

/// foxglove.CameraCalibration.
FoxgloveMessage CalibrationMessage(const LensCamera& camera, int64_t utime,
                                   const std::string& frame_id);

/// foxglove.FrameTransform: the pose of `child` in `parent`.
FoxgloveMessage TransformMessage(const std::string& parent, const std::string& child,
                                 const Pose& T_parent_child, int64_t utime);

/// The pose of a camera in W as foxglove.PoseInFrame.
FoxgloveMessage PoseMessage(const Pose& T_W_C, int64_t utime);

/// The way of a camera in W as foxglove.PosesInFrame.
FoxgloveMessage PathMessage(std::span<const Pose> T_W_C, int64_t utime);

/// The detections of a frame as foxglove.ImageAnnotations: the outline of each mask, with class
/// and score as metadata and as a text. Masks without pixels are left out.
FoxgloveMessage DetectionsMessage(const DetectionSet& set, const ClassNamer& class_name);

/// The segments of a frame as a picture in colours (PNG, foxglove.CompressedImage), black where
/// there is none. The image must have at least one pixel.
FoxgloveMessage SegmentsMessage(const SegmentImage& image, int64_t utime,
                                const std::string& frame_id);

/// How urgent a message for people is; the numbers are those of foxglove.Log.
enum class NoteLevel : int8_t { kInfo = 2, kWarning = 3, kError = 4 };

/// foxglove.Log. `name` = of the process. Texts may have any bytes.
FoxgloveMessage NoteMessage(NoteLevel level, const std::string& name, const std::string& text,
                            int64_t utime);

}  // namespace vismap
