#pragma once

#include <map>
#include <vector>

#include "geometry/frame.h"
#include "simulation/simulate.h"
#include "simulation/synthetic_dataset.h"
#include "simulation/tessellate.h"

namespace vismap {

/// What the cameras of a sequence saw of a scene: the part of its truth that a map can be measured
/// by.
class SeenSurface {
 public:
  /// One more frame, and what an ideal camera renders there. All cameras must be alike.
  void AddView(const FrameHeader& header, Rendering&& image);

  /// Frames that show an object with at least 50 pixels, by SceneObject::id.
  const std::map<uint16_t, int>& frames_of_object() const { return frames_of_object_; }

  /// Whether some camera saw this point of the surface: it was the nearest thing in its pixel.
  bool Saw(const Eigen::Vector3d& p_W) const;

  /// The seen part of the scene's surface, see Tessellate. `spacing` [m].
  LabelledMesh Triangles(const Scene& scene, double spacing) const;

 private:
  PinholeCamera camera_;
  std::vector<Pose> T_C_W_;
  std::vector<Image<float>> depths_;
  std::map<uint16_t, int> frames_of_object_;
};

/// All frames of a computed sequence.
SeenSurface LookAround(const SyntheticOptions& options);

}  // namespace vismap
