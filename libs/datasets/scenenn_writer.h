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

/// The colour image of a frame as the bytes of a file.
struct ColorFile {
  const char* suffix;  ///< ".png" or ".jpg"
  std::vector<uint8_t> bytes;
};

/// Writes a sequence in SceneNN's layout (see scenenn.cc): image/, depth/ (16-bit), timestamp.txt,
/// trajectory.log, detections.json (COCO results). Reading it back gives the same sequence. After
/// the first error, nothing more is written; the error is status().
class SceneNnWriter {
 public:
  explicit SceneNnWriter(std::filesystem::path folder);
  ~SceneNnWriter();
  SceneNnWriter(const SceneNnWriter&) = delete;
  SceneNnWriter& operator=(const SceneNnWriter&) = delete;

  /// Writes the images of the next frame. Their names have header.frame_number, which is >= 1.
  /// Frame numbers and utimes must increase, or the sequence cannot be read back.
  void AddFrame(const FrameHeader& header, const Image<uint16_t>& depth, const ColorFile& color);
  /// Adds the detections of a frame, with set.frame_number as image_id. detections.json is written
  /// only if this was called, if only with empty sets.
  void AddDetections(const DetectionSet& set);
  /// Writes any other file, at a path relative to the folder.
  void Write(const std::filesystem::path& name, std::span<const uint8_t> bytes);
  void Write(const std::filesystem::path& name, const std::string& text);
  /// Writes the files with data of all frames. Fails with the name of the first file that could not
  /// be written.
  Result<void> Finish();

  const Result<void>& status() const { return status_; }

 private:
  struct Results;
  std::filesystem::path folder_;
  Result<void> status_;
  std::string trajectory_, times_;
  std::unique_ptr<Results> results_;  // none before the first AddDetections
};

/// The text of intrinsic/asus.ini. `rate` = frames per second. The key depth_unit_m, which SceneNN
/// does not have, is written only if the unit is not a millimetre.
std::string SceneNnIni(const PinholeCamera& camera, double rate, double depth_unit_m = 0.001);

/// The image as a 16-bit PNG file with one channel.
std::vector<uint8_t> EncodePng16(const Image<uint16_t>& image);

}  // namespace vismap
