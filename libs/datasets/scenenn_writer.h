#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// Colour of a frame as a file.
struct ColorFile {
  const char* suffix;  ///< ".png" or ".jpg"
  std::vector<uint8_t> bytes;
};

/// Writes a sequence as SceneNN's players extract it (see scenenn.cc), so that it reads back the
/// same: image/ depth/ (16-bit) timestamp.txt trajectory.log detections.json (COCO results). The
/// first failure is kept; what comes after it is not written.
class SceneNnWriter {
 public:
  explicit SceneNnWriter(std::filesystem::path folder);
  ~SceneNnWriter();
  SceneNnWriter(const SceneNnWriter&) = delete;
  SceneNnWriter& operator=(const SceneNnWriter&) = delete;

  /// The next frame; header.frame_number (>= 1) goes into the names of its files. Numbers and
  /// utimes must ascend to be read back.
  void AddFrame(const FrameHeader& header, const Image<uint16_t>& depth, const ColorFile& color);
  /// image_id is set.frame_number. The file is written when this has been called, be it with an
  /// empty set: a detector looked.
  void AddDetections(const DetectionSet& set);
  /// Any other file, at a path below the folder.
  void Write(const std::filesystem::path& name, std::span<const uint8_t> bytes);
  void Write(const std::filesystem::path& name, const std::string& text);
  /// Writes what was collected of all frames. Fails naming the first file that cannot be written.
  Result<void> Finish();

  const Result<void>& status() const { return status_; }

 private:
  struct Results;
  std::filesystem::path folder_;
  Result<void> status_;
  std::string trajectory_, times_;
  std::unique_ptr<Results> results_;  // none while no detector looked
};

/// intrinsic/asus.ini, which stands in the folder of a sequence or beside it. `rate` = frames a
/// second. Our own key depth_unit_m is only there when it is not SceneNN's millimetre.
std::string SceneNnIni(const PinholeCamera& camera, double rate, double depth_unit_m = 0.001);

/// A 16-bit PNG, lossless.
std::vector<uint8_t> EncodePng16(const Image<uint16_t>& image);

}  // namespace vismap
