#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "simulation/simulate.h"

namespace vismap {

/// A computed sequence, written
/// "synthetic:room?frames=80&width=640&noise=kinect&seed=1&rate=10&tours=1"; all parameters
/// optional, in any order; those below are named alike. "remove=ID@FRAME" takes an object away
/// before that frame, "appear=ID@FRAME" has it there only from that frame on, and
/// "move=ID@FRAME,DX,DY" moves it by so many metres before that frame; all any number of times.
/// Scenes are "room" (see room.h) and "office" (see office.h), where 400 frames are the default.
/// All errors depend on the seed alone.
struct SyntheticOptions {
  std::string scene = "room";
  int frames = 80;    ///< on one closed tour of the scene, 1..100000
  int width = 640;    ///< [px], 16..4096; height is 3/4 of it, focal length 525/640 of it
  bool noise = true;  ///< "kinect" or "none": sensor and detector errors
  uint64_t seed = 1;
  double rate = 10;  ///< frames a second
  int tours = 1;     ///< how often the tour is made, 1..10000; the errors are others each time

  /// Probability that the detector sees an object, 0..1; absent = 0.9, without noise 1.
  std::optional<double> detection_rate{};
  double class_confusion = 0;  ///< probability of another one of the scene's classes, 0..1
  /// Masks are grown or shrunk by up to so many pixels, 0..64; absent = 2, without noise 0. What is
  /// above 2 also moves them by up to as much, makes their rims waver with half of it as deviation,
  /// and puts holes in them (see MaskNoise).
  std::optional<int> mask_noise{};
  int detect_every = 1;    ///< the detector looks at every n-th frame only, 1..100000
  double pose_noise = 0;   ///< deviation of the given pose [m], 0..1; turned with it (PoseNoise)
  double depth_noise = 1;  ///< factor on the sensor's noise, 0..10; nothing without noise

  /// An object of the scene that comes, goes or is moved.
  struct Change {
    uint16_t object_id = 0;
    int64_t frame = 0;  ///< number of the first frame that shows the change; frames count from 1
    bool appears = false;
    std::optional<Eigen::Vector2d> moved{};  ///< by so much along x and y of W [m]
  };
  std::vector<Change> changes = {};
};

/// Whether a path names a computed sequence.
bool IsSyntheticPath(const std::string& path);

/// Fails naming the parameter when it is unknown or out of range.
Result<SyntheticOptions> ParseSyntheticPath(const std::string& path);
/// The path that is parsed to these options.
std::string SyntheticPath(const SyntheticOptions& options);

/// The truth behind a computed sequence.
Scene MakeScene(const SyntheticOptions& options);
/// True headers of all its frames, poses without noise: frame_number from 1, as SceneNN counts;
/// utime = frame_number / rate.
std::vector<FrameHeader> MakeHeaders(const SyntheticOptions& options);

/// Frames seen from the true poses, which they give with `pose_noise`.
std::unique_ptr<Dataset> MakeSyntheticDataset(const SyntheticOptions& options,
                                              const DatasetOptions& selection);
std::unique_ptr<DetectionSource> MakeSyntheticDetections(const SyntheticOptions& options);

}  // namespace vismap
