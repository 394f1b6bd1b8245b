#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "base/result.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// The detections of the frames of a sequence.
class DetectionSource {
 public:
  virtual ~DetectionSource() = default;
  /// The detections of the frame with this header; an empty set if the detector found nothing. The
  /// frame is identified by frame_number, in a log by camera_id and utime. The set has the header's
  /// utime, camera_id and frame_number. Fails if a mask does not have the size of the header's
  /// camera. Several threads may call it at once.
  virtual Result<DetectionSet> ForFrame(const FrameHeader& header) const = 0;
  /// Whether the detector ran on this frame. If not, the frame counts as one without a detector,
  /// which is different from an empty set of detections.
  virtual bool DetectorRan(const FrameHeader&) const { return true; }
  /// Number of detections in all frames; -1 = unknown before every frame has been read.
  virtual int64_t size() const = 0;
  /// The lowest and the highest frame_number that has detections; nullopt = unknown, or there are
  /// none.
  virtual std::optional<std::pair<int64_t, int64_t>> frame_numbers() const { return std::nullopt; }
};

/// Reads a file of COCO "results": a JSON array of {"image_id", "category_id", "score",
/// "segmentation": {"size": [h, w], "counts": compressed string or run lengths}}. image_id is the
/// frame_number. Fails, naming the file and the entry, if it is malformed.
Result<std::unique_ptr<DetectionSource>> LoadCocoResults(const std::string& path);

/// Writes the detections of some frames as such a file, with compressed masks. Fails if a frame
/// with detections has no frame_number, if a class is unknown, or if the file cannot be written.
Result<void> WriteCocoResults(const std::string& path, std::span<const DetectionSet> frames);

/// Reads a folder of 16-bit PNGs, one per frame, whose pixels are instance ids (0 = none), and a
/// table with the class and the score of each id. The last number in a file's name is the
/// frame_number. The table is `table_path`, or, if that is empty, instances.csv or instances.json
/// in the folder. A .csv file has a header line with the columns id, category_id and optionally
/// score and image_id; a .json file is an array of objects with these keys. A row with image_id is
/// valid only for that frame. An instance with category_id 0 is not a detection. Fails, naming the
/// file, if it is malformed; an id without a row in the table is an error of its frame.
Result<std::unique_ptr<DetectionSource>> LoadInstancePngs(const std::string& folder,
                                                          const std::string& table_path = "");

/// Reads detections: LoadInstancePngs for a folder, LoadCocoResults for a file.
Result<std::unique_ptr<DetectionSource>> LoadDetections(const std::string& path);

}  // namespace vismap
