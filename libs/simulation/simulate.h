#pragma once

#include <cstdint>

#include "geometry/frame.h"
#include "geometry/noise_model.h"
#include "segmentation/detections.h"
#include "simulation/mask_noise.h"
#include "simulation/scene.h"

namespace vismap {

/// What an ideal camera sees. All images HxW of the camera.
struct Rendering {
  Image<float> depth;          ///< exact [m] along optical z; NaN = nothing there
  Image<uint16_t> object_ids;  ///< SceneObject::id; 0 = nothing
  Image<Rgb8> color;           ///< checkered, shaded by the angle to a fixed light
};

/// Casts one ray through the centre of every pixel.
Rendering Render(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C);

/// Errors of a depth camera that measures disparities; by default of a Kinect.
struct DepthNoise {
  bool enabled = true;
  uint64_t seed = 1;  ///< another seed, other errors; the same seed, the same errors
  double scale = 1;   ///< of noise and disparity steps; 0 = exact but for dropouts
  DepthNoiseModel axial = KinectNoise();  ///< its deviation along the axis
  double baseline = 0.075;                ///< projector to camera, or between both cameras [m]
  double disparity_step = 0.125;  ///< disparities are measured in such steps; 0 = no steps [px]
  int correlation = 4;            ///< errors vary over so many pixels, as matching windows do; >= 1
  double edge_dropout = 0.5;      ///< probability that a pixel beside a depth step has no return
  double grazing_cosine = 0.12;   ///< no return where |cos| of view ray and normal is below
  double min_depth = 0.35;        ///< no return nearer [m]
  double max_depth = 8.0;         ///< no return beyond [m]
};

/// The errors of an Intel RealSense D400, and of a renderer that keeps whole millimetres.
DepthNoise RealSenseDepthNoise();
DepthNoise CleanDepthNoise();

/// Depth with errors: axial deviation `scale` times that of the model in total, made of correlated
/// noise and disparity steps; dropouts as given. `frame` makes
/// frames differ.
Image<float> AddDepthNoise(const Image<float>& depth, const PinholeCamera& camera,
                           const DepthNoise& noise, uint64_t frame);

/// The frame that a sensor with this header delivers: depth in whole mm, colour as JPEG. `noise` is
/// drawn for header.frame_number.
SensorFrame RenderFrame(const Scene& scene, const FrameHeader& header, const DepthNoise& noise);

/// True object ids per pixel; 0 = nothing.
Image<uint16_t> RenderInstances(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C);

/// Errors of a simulated detector.
struct DetectorNoise {
  uint64_t seed = 1;
  double miss_rate = 0.1;  ///< probability that an object is not detected in a frame
  /// Probability that a detection carries another one of the scene's classes.
  double class_confusion = 0;
  MaskNoise mask;
  int min_pixels = 150;  ///< smaller objects are not detected, at 640x480; scales with the image
};

/// Detections of the known objects in an instance image, one per object, in order of their ids.
/// Scores in [0.6, 1).
DetectionSet SimulateDetections(const Scene& scene, const Image<uint16_t>& object_ids,
                                const FrameHeader& header, const DetectorNoise& noise);

}  // namespace vismap
