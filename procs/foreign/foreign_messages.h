#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "foreign/foreign_image.h"
#include "foreign/frame_tree.h"

namespace vismap {

/// The optics of a camera as a robot's message or the config states them.
struct ForeignCamera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  enum class Distortion { kNone, kBrownConrady, kEquidistant } distortion = Distortion::kNone;
  std::vector<double> coefficients = {};
  friend bool operator==(const ForeignCamera&, const ForeignCamera&) = default;
};

/// The distortion by the name of its model: "" and "none", "plumb_bob" (4, 5 or 8 coefficients),
/// "rational_polynomial" (8), "equidistant" and "kannala_brandt4" (4). Coefficients that are all 0
/// are none. Fails on other names and numbers of coefficients.
Result<void> SetDistortion(const std::string& model, const std::vector<double>& coefficients,
                           ForeignCamera* camera);

/// What the images on a channel are, where the message does not say it.
enum class ImageRole { kColor, kDepth };

/// What a message says, as far as a map needs it.
struct ForeignMessage {
  std::optional<ForeignImage> color, depth;
  std::optional<ForeignCamera> camera;
  std::vector<EdgeSample> edges;
  /// Sentences about the poses and images in it that cannot be used; each names its frame or type.
  std::vector<std::string> left_out;
};

/// How messages are read that do not say everything themselves.
struct ForeignMessageOptions {
  ImageRole role = ImageRole::kColor;
  std::string root;        ///< parent of poses that name none
  std::string body_frame;  ///< child of poses of the robot that name none
  /// Child of rigid transforms on channels that do not name their frames as CHILD_TO_PARENT.
  /// Capitals in these names do not matter when they are those of the frames above and of this one.
  std::string camera_frame;
  /// Which images of a message with several are decoded: the first of each kind that can be used.
  bool color = true, depth = true;
};

/// Decodes a message of DimOS (Image, CameraInfo, TFMessage, PoseStamped, Odometry), Drake (image
/// array, viewer draw) or bot_core (images, image, pose, rigid transform); the fingerprint says
/// which. A pose or image that cannot be used is left out: poses that are not rigid, of frames
/// without names, with too long ones or in themselves, at times below 0 or above kLatestUtime.
/// Times of images are not judged. Fails on other types, and, naming the field, on a message of
/// which nothing can be used.
Result<ForeignMessage> DecodeForeign(std::span<const uint8_t> bytes, const std::string& channel,
                                     const ForeignMessageOptions& options);

/// The latest time that a message can have [us], in the year 2255, so that sums do not overflow.
inline constexpr int64_t kLatestUtime = int64_t{1} << 53;

/// Time of a stamp [us], rounded: DimOS sends stamps through float seconds.
int64_t UtimeOf(int32_t sec, int32_t nsec);

}  // namespace vismap
