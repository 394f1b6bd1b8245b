#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/ids.h"
#include "geometry/frame.h"
#include "geometry/image.h"
#include "map/block.h"
#include "viewer/page_messages.h"

namespace vismap {

/// The surface of a block as pages get it, see EncodePageBlock.
struct SurfaceBlock {
  BlockIndex index;
  FrameBytes bytes;
};
using SurfaceBlocks = std::shared_ptr<const std::vector<SurfaceBlock>>;

/// Which surface is that of an object: of an instance, or of segments that have no instance.
struct ObjectChoice {
  InstanceId instance = InstanceId::kNone;
  std::vector<uint32_t> segments;  ///< labels, ascending; used when there is no instance
  friend bool operator==(const ObjectChoice&, const ObjectChoice&) = default;
};

/// At most about `most` points of the object's surface in W [m], evenly chosen.
std::vector<Eigen::Vector3f> SampleObject(std::span<const SurfaceBlock> blocks,
                                          const ObjectChoice& object, size_t most);

/// The object's surface as a camera sees it.
struct ObjectMask {
  Image<uint8_t> visible;  ///< 1 = the nearest surface in this pixel is the object's
  Image<float> closeness;  ///< of the nearest surface: 1 / depth [1/m]; 0 = none
  int pixels = 0;          ///< where it is visible
  int pixels_alone = 0;    ///< where it would be visible if there were nothing else
};
/// Draws the surface into an image of the camera's size. Both sides of triangles are drawn, but not
/// those that reach nearer than 5 cm to the camera.
ObjectMask DrawObjectMask(std::span<const SurfaceBlock> blocks, const ObjectChoice& object,
                          const PinholeCamera& camera, const Pose& T_W_C);

/// The camera of the picture that is `step` times smaller, whose pixels are every step-th one.
PinholeCamera SmallerCamera(const PinholeCamera& camera, int step);

/// Takes away pixels where the depth that the camera measured is another one: something else stood
/// in front at that time, or the object was not there. `depth_mm` is every `depth_step`-th pixel of
/// the image of which the mask is every `mask_step`-th. A pixel stays when one of the nine measured
/// depths around it fits, or none was measured.
void KeepMeasured(const Image<uint16_t>& depth_mm, int depth_step, int mask_step, ObjectMask* mask);

/// Whether a depth [m] fits to one of the nine measured depths around this pixel of `depth_mm`, or
/// none was measured.
bool FitsMeasured(const Image<uint16_t>& depth_mm, int row, int column, double depth);

}  // namespace vismap
