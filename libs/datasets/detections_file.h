#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/result.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// Somebody who knows what a detector saw in each frame of a sequence.
class DetectionSource {
 public:
  virtual ~DetectionSource() = default;
  /// The detections of the frame with this header (found by its frame_number, in a log by
  /// camera_id and utime; utime and camera_id are copied); an empty set when the detector found
  /// nothing. Fails when a mask has not the size of the frame's camera. May be called from several
  /// threads at once.
  virtual Result<DetectionSet> ForFrame(const FrameHeader& header) const = 0;
  /// Whether the detector looked at this frame. If not, the frame goes on as one without a
  /// detector, which is not the same as an empty set.
  virtual bool LookedAt(const FrameHeader&) const { return true; }
  /// Detections in all frames together; -1 = unknown before asking for each.
  virtual int64_t size() const = 0;
};

/// Reads COCO "results": a JSON array of {"image_id", "category_id", "score", "segmentation":
/// {"size": [h, w], "counts": compressed string or run lengths}}; image_id is the frame_number.
/// Fails naming the file and the entry.
Result<std::unique_ptr<DetectionSource>> LoadCocoResults(const std::string& path);

/// Writes the detections of many frames as such a file, masks compressed. Fails when a frame has no
/// frame_number to be found by, a class is unknown, and on what WriteFileAtomically fails on.
Result<void> WriteCocoResults(const std::string& path, std::span<const DetectionSet> frames);

/// Reads a folder of 16-bit PNGs, one per frame (the last number in the file name is the
/// frame_number), each pixel an instance id, 0 = none, with a table `id -> class, score`.
/// `table_path` ends in .csv (a header line naming the columns id, category_id, and optionally
/// score, image_id) or .json (an array of objects with these keys); "" = instances.csv or
/// instances.json in the folder. With image_id a row holds for that frame alone. category_id 0 =
/// not a detection. An id without a row is an error.
Result<std::unique_ptr<DetectionSource>> LoadInstancePngs(const std::string& folder,
                                                          const std::string& table_path = "");

/// LoadInstancePngs for a folder, LoadCocoResults for a file.
Result<std::unique_ptr<DetectionSource>> LoadDetections(const std::string& path);

}  // namespace vismap
