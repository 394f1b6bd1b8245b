#pragma once

#include <map>
#include <vector>

#include "geometry/frame.h"
#include "simulation/simulate.h"
#include "simulation/synthetic_dataset.h"
#include "simulation/tessellate.h"

namespace vismap {

/// The part of a scene's surface that the cameras of a sequence saw. A map is compared with this
/// part.
class SeenSurface {
 public:
  /// Adds a frame with the exact image of its camera. All frames must have the same camera
  /// parameters.
  void AddView(const FrameHeader& header, Rendering&& image);

  /// For each SceneObject::id, the number of frames that show the object with at least 50 pixels.
  const std::map<uint16_t, int>& frames_of_object() const { return frames_of_object_; }

  /// Whether some frame saw this point of the surface [m], with nothing in front of it.
  bool IsSeen(const Eigen::Vector3d& p_W) const;

  /// The part of the scene's surface that some frame saw, as triangles with edges of about
  /// `spacing` [m] (see Tessellate).
  LabelledMesh Triangles(const Scene& scene, double spacing) const;

 private:
  PinholeCamera camera_;
  std::vector<Pose> T_C_W_;
  std::vector<Image<float>> depths_;
  std::map<uint16_t, int> frames_of_object_;
};

/// Renders all frames of a computed sequence and returns the surface that they saw.
SeenSurface RenderSeenSurface(const SyntheticOptions& options);

}  // namespace vismap
