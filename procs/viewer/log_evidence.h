#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "segmentation/segmented_frame.h"
#include "viewer/evidence_answers.h"
#include "viewer/evidence_finder.h"
#include "viewer/log_recording.h"

namespace vismap {

/// The frames of a log that are kept to show objects in them. One thread adds, another one reads.
class LogFrames {
 public:
  /// `max_bytes`: see EvidenceStore; 0 = none is kept.
  explicit LogFrames(size_t max_bytes);

  /// A frame for Add, if it would be kept; else, and when it has no colour, nullptr.
  std::shared_ptr<EvidenceFrame> Make(const SegmentedFrame& frame) const;
  /// Keeps the frame, which was the newest one of the map after `frames` frames.
  void Add(std::shared_ptr<EvidenceFrame> frame, int64_t frames);
  /// What is kept of the first `frames` frames.
  EvidenceStore Until(int64_t frames) const;

 private:
  mutable std::mutex mutex_;
  EvidenceStore store_;
};

/// Answers in which frames of a log an object is seen, see EvidenceList and EvidencePicture: with
/// the surface at a moment, and of the frames until then. For one thread.
class LogEvidence {
 public:
  /// Both must outlive it.
  LogEvidence(const LogRecording* recording, const LogFrames* frames)
      : recording_(recording), frames_(frames), finder_(0, 0) {}

  HttpAnswer List(const std::string& name, int64_t frames);
  HttpAnswer Picture(const PictureQuestion& picture, int64_t frames);

 private:
  Result<EvidenceQuestion> Ask(const std::string& name, int64_t frames);
  Result<SurfaceBlocks> Blocks(int64_t frames);
  Result<std::vector<uint32_t>> SegmentsOf(uint32_t segment, int64_t frames) const;

  const LogRecording* recording_;
  const LogFrames* frames_;
  EvidenceFinder finder_;
  SurfaceBlocks blocks_;  // of the last question:
  int64_t blocks_frames_ = -1, blocks_thinnings_ = -1;
};

}  // namespace vismap
