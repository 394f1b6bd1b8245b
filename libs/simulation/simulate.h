#pragma once

#include <cstdint>

#include "geometry/frame.h"
#include "geometry/noise_model.h"
#include "segmentation/detections.h"
#include "simulation/mask_noise.h"
#include "simulation/scene.h"

namespace vismap {

/// The images of a camera without errors, all HxW.
struct Rendering {
  Image<float> depth;          ///< exact depth along optical z [m]; NaN = no object
  Image<uint16_t> object_ids;  ///< SceneObject::id; 0 = no object
  Image<Rgb8> color;           ///< checkered, shaded by the angle to a fixed light
};

/// Renders a scene with one ray through the centre of every pixel.
Rendering Render(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C);

/// Errors of a depth camera that measures disparities. The defaults are those of a Kinect.
struct DepthNoise {
  bool enabled = true;
  uint64_t seed = 1;  ///< the errors are a function of the seed and the frame
  double scale = 1;   ///< factor on noise and disparity steps; 0 = exact except for dropouts
  DepthNoiseModel axial = KinectNoise();  ///< deviation along the optical axis
  double baseline = 0.075;                ///< between projector and camera, or the two cameras [m]
  double disparity_step = 0.125;  ///< disparities are multiples of this [px]; 0 = not rounded
  int correlation = 4;            ///< correlation length of the errors [px]; >= 1
  double edge_dropout = 0.5;      ///< probability that a pixel beside a depth step has no return
  double grazing_cosine = 0.12;   ///< no return if |cos| of view ray and normal is smaller
  double min_depth = 0.35;        ///< no return from nearer [m]
  double max_depth = 8.0;         ///< no return from farther [m]
};

/// Adds errors to a depth image [m]: correlated noise and disparity steps, which together have
/// `scale` times the axial deviation of the model, and dropouts (NaN). The errors are a function of
/// noise.seed and `frame`.
Image<float> AddDepthNoise(const Image<float>& depth, const PinholeCamera& camera,
                           const DepthNoise& noise, uint64_t frame);

/// The frame that a sensor with this header measures: depth in whole millimetres, colour as JPEG.
/// The errors are those of frame header.frame_number.
SensorFrame RenderFrame(const Scene& scene, const FrameHeader& header, const DepthNoise& noise);

/// The object id of each pixel (HxW); 0 = no object.
Image<uint16_t> RenderInstances(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C);

/// Errors of a simulated detector.
struct DetectorNoise {
  uint64_t seed = 1;       ///< the errors are a function of the seed and the frame
  double miss_rate = 0.1;  ///< probability that an object is not detected in a frame
  /// Probability that a detection has another one of the scene's classes.
  double class_confusion = 0;
  MaskNoise mask;
  int min_pixels =
      150;  ///< objects with fewer pixels are not detected; for 640x480, scaled to the image
};

/// The detections of the known objects in an instance image, at most one per object, in order of
/// their ids. Scores are in [0.6, 1).
DetectionSet SimulateDetections(const Scene& scene, const Image<uint16_t>& object_ids,
                                const FrameHeader& header, const DetectorNoise& noise);

}  // namespace vismap
