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

/// The parameters of a computed sequence. As text:
/// "synthetic:room?frames=80&width=640&noise=kinect&seed=1&rate=10&tours=1". All parameters are
/// optional, in any order, and have the names of the members below. The scenes are "room" (see
/// room.h) and "office" (see office.h; 400 frames by default). Changes of the scene, any number of
/// them: "remove=ID@FRAME": the object is absent from that frame on; "appear=ID@FRAME": the object
/// is present only from that frame on; "move=ID@FRAME,DX,DY": from that frame on, the object is
/// moved by so many metres along x and y of W. All errors are functions of the seed.
struct SyntheticOptions {
  std::string scene = "room";
  int frames = 80;         ///< of one closed tour of the scene, 1..100000
  int width = 640;         ///< [px], 16..4096; height is 3/4 of it, focal length 525/640 of it
  bool realsense = false;  ///< camera "ideal" or "realsense" (see realsense.h; without `width`)
  bool noise = true;       ///< "kinect" or "none": errors of sensor and detector
  uint64_t seed = 1;
  double rate = 10;  ///< frames per second
  int tours = 1;     ///< number of tours, 1..10000; the errors differ between them

  /// Probability that an object is detected, 0..1; not set = 0.9, or 1 without noise.
  std::optional<double> detection_rate{};
  double class_confusion = 0;  ///< probability of another one of the scene's classes, 0..1
  /// Masks are grown or shrunk by up to so many pixels n, 0..64; not set = 2, or 0 without noise.
  /// If n is above 2, masks are also moved by up to n - 2 pixels, and their borders vary with a
  /// deviation of (n - 2) / 2 pixels, with holes (see MaskNoise).
  std::optional<int> mask_noise{};
  int detect_every = 1;    ///< the detector runs on every n-th frame, 1..100000
  double pose_noise = 0;   ///< deviation of the poses [m], 0..1; includes rotation (PoseNoise)
  double drift = 0;        ///< of the poses: share of the way, 0..0.2 (PoseDrift)
  double turn_drift = 0;   ///< of the poses: turn about z of W [deg/m], 0..10 (PoseDrift)
  double depth_noise = 1;  ///< factor on the sensor's noise, 0..10; not used without noise

  /// A change of an object of the scene: it is removed, appears or is moved.
  struct Change {
    uint16_t object_id = 0;
    int64_t frame = 0;  ///< number of the first frame that shows the change; frames count from 1
    bool appears = false;
    std::optional<Eigen::Vector2d> moved{};  ///< translation along x and y of W [m]
  };
  std::vector<Change> changes = {};
};

/// Whether a path is the text of a computed sequence.
bool IsSyntheticPath(const std::string& path);

/// Parses the text of a computed sequence. Fails, naming the parameter, if it is unknown or out of
/// range.
Result<SyntheticOptions> ParseSyntheticPath(const std::string& path);
/// The text from which ParseSyntheticPath makes these options.
std::string SyntheticPath(const SyntheticOptions& options);

/// The scene of a computed sequence, with its changes.
Scene MakeScene(const SyntheticOptions& options);
/// The headers of all frames with the true poses. frame_number counts from 1, as in SceneNN; utime
/// = frame_number / rate.
std::vector<FrameHeader> MakeHeaders(const SyntheticOptions& options);

/// The frames of a computed sequence. Images are rendered at the true poses; the poses in the
/// headers have `drift`, `turn_drift` and `pose_noise`.
std::unique_ptr<Dataset> MakeSyntheticDataset(const SyntheticOptions& options,
                                              const DatasetOptions& selection);
/// The simulated detections of a computed sequence.
std::unique_ptr<DetectionSource> MakeSyntheticDetections(const SyntheticOptions& options);

}  // namespace vismap
