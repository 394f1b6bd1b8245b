#include "foreign/foreign_messages.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>
#include <vismap/foreign/bot_core/image_t.hpp>
#include <vismap/foreign/bot_core/images_t.hpp>
#include <vismap/foreign/bot_core/pose_t.hpp>
#include <vismap/foreign/bot_core/rigid_transform_t.hpp>
#include <vismap/foreign/drake/lcmt_image_array.hpp>
#include <vismap/foreign/drake/lcmt_viewer_draw.hpp>
#include <vismap/foreign/geometry_msgs/PoseStamped.hpp>
#include <vismap/foreign/nav_msgs/Odometry.hpp>
#include <vismap/foreign/sensor_msgs/CameraInfo.hpp>
#include <vismap/foreign/sensor_msgs/Image.hpp>
#include <vismap/foreign/tf2_msgs/TFMessage.hpp>

#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

constexpr size_t kMostFrameName = 256;  // characters

using Options = ForeignMessageOptions;

// w, x, y, z and translation.
Result<Pose> PoseOf(const Eigen::Vector4d& wxyz, const Eigen::Vector3d& translation) {
  const double norm = wxyz.norm();
  if (!(std::abs(norm - 1) < 0.01) || !translation.allFinite())
    return Fail("a pose is not finite, or its quaternion does not have unit length");
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

template <typename Position, typename Rotation>
Result<Pose> RosPose(const Position& position, const Rotation& rotation) {
  return PoseOf({rotation.w, rotation.x, rotation.y, rotation.z},
                {position.x, position.y, position.z});
}

Result<void> CheckFrames(const std::string& parent, const std::string& child) {
  if (parent.empty() || child.empty()) return Fail("a frame has no name");
  if (const size_t size = std::max(parent.size(), child.size()); size > kMostFrameName)
    return Fail("a frame's name has " + std::to_string(size) + " characters; at most " +
                std::to_string(kMostFrameName) + " are allowed");
  if (parent == child) return Fail("a frame is its own parent");
  return {};
}

// Adds the pose of a child in its parent, or says why it is left out.
void AddEdge(const std::string& type, const std::string& parent, const std::string& child,
             int64_t utime, const Result<Pose>& pose, ForeignMessage* message) {
  const auto leave_out = [&](const std::string& why) {
    message->left_out.push_back(type + ", the pose of '" + child.substr(0, kMostFrameName) +
                                "' in '" + parent.substr(0, kMostFrameName) + "': " + why);
  };
  if (const Result<void> frames = CheckFrames(parent, child); !frames)
    return leave_out(frames.error().message);
  if (!pose) return leave_out(pose.error().message);
  if (utime < 0 || utime > kLatestUtime)
    return leave_out("its time " + std::to_string(utime) + " us is impossible");
  message->edges.push_back({parent, child, utime, *pose});
}

ForeignMessage OneEdge(const std::string& type, const std::string& parent, const std::string& child,
                       int64_t utime, const Result<Pose>& pose) {
  ForeignMessage message;
  AddEdge(type, parent, child, utime, pose, &message);
  return message;
}

// Decodes an image when it is the first of its kind in the message.
template <typename Decode>
void AddImage(bool wanted, const Decode& decode, std::optional<ForeignImage>* image,
              ForeignMessage* message) {
  if (!wanted || *image) return;
  Result<ForeignImage> decoded = decode();
  if (decoded) {
    *image = std::move(*decoded);
  } else {
    message->left_out.push_back(decoded.error().message);
  }
}

ForeignMessage OneImage(ForeignImage image, ImageRole role) {
  ForeignMessage message;
  (role == ImageRole::kDepth ? message.depth : message.color) = std::move(image);
  return message;
}

// ---- DimOS: the types of ROS.

/// An encoding of sensor_msgs.Image.
struct RosEncoding {
  const char* name;
  PixelFormat format;
  int pixel_bytes, value_bytes;
};
constexpr RosEncoding kRosEncodings[] = {
    {"rgb8", PixelFormat::kRgb, 3, 1},         {"bgr8", PixelFormat::kBgr, 3, 1},
    {"rgba8", PixelFormat::kRgba, 4, 1},       {"bgra8", PixelFormat::kBgra, 4, 1},
    {"mono8", PixelFormat::kGrey, 1, 1},       {"mono16", PixelFormat::kDepth16, 2, 2},
    {"16UC1", PixelFormat::kDepth16, 2, 2},    {"16SC1", PixelFormat::kDepth16, 2, 2},
    {"32FC1", PixelFormat::kDepthFloat, 4, 4}, {"64FC1", PixelFormat::kDepthFloat, 8, 8}};

// Makes the format what the pipeline knows: no signed depth, no doubles, no grey with 16 bits.
void SimplifyRos(const std::string& encoding, ImageRole role, ForeignImage* image) {
  if (encoding == "64FC1") image->bytes = FloatsOfDoubles(image->bytes);
  if (encoding == "16SC1") ClearNegative(&image->bytes);
  if (encoding == "mono16" && role == ImageRole::kColor) {
    image->bytes = UpperBytes(image->bytes);
    image->format = PixelFormat::kGrey;
  }
}

bool IsDepthFormat(PixelFormat format) { return format >= PixelFormat::kDepth16; }

Result<ForeignMessage> FromRosImage(foreign::sensor_msgs::Image& message, const Options& options) {
  ForeignImage image{UtimeOf(message.header.stamp.sec, message.header.stamp.nsec),
                     message.header.frame_id, message.width, message.height};
  if (message.encoding == "jpeg" || message.encoding == "png") {
    const bool depth = options.role == ImageRole::kDepth;
    if (depth && message.encoding == "jpeg")
      return Fail("Image.encoding is 'jpeg', which cannot hold depth");
    image.format = message.encoding == "jpeg" ? PixelFormat::kJpeg
                   : depth                    ? PixelFormat::kDepthPng
                                              : PixelFormat::kPng;
    image.bytes = std::move(message.data);
    return OneImage(std::move(image), options.role);
  }
  const auto found = std::find_if(std::begin(kRosEncodings), std::end(kRosEncodings),
                                  [&](const RosEncoding& e) { return message.encoding == e.name; });
  if (found == std::end(kRosEncodings))
    return Fail("Image.encoding '" + message.encoding + "' is unknown");
  image.format = found->format;
  Result<std::vector<uint8_t>> bytes =
      TightRows({message.width, message.height, message.step, found->pixel_bytes,
                 found->value_bytes, message.is_bigendian != 0, std::move(message.data)});
  if (!bytes) return Fail("Image: " + bytes.error().message);
  image.bytes = std::move(*bytes);
  SimplifyRos(message.encoding, options.role, &image);
  if (IsDepthFormat(image.format) != (options.role == ImageRole::kDepth)) {
    return Fail("Image.encoding '" + message.encoding + "' is not one of " +
                (options.role == ImageRole::kDepth ? "a depth image" : "a colour image"));
  }
  return OneImage(std::move(image), options.role);
}

Result<ForeignMessage> FromCameraInfo(foreign::sensor_msgs::CameraInfo& message, const Options&) {
  if (message.binning_x > 1 || message.binning_y > 1)
    return Fail("CameraInfo: images with binning are not supported");
  ForeignCamera camera{message.width, message.height, message.K[0],
                       message.K[4],  message.K[2],   message.K[5]};
  if (const auto set = SetDistortion(message.distortion_model, message.D, &camera); !set)
    return Fail("CameraInfo: " + set.error().message);
  ForeignMessage result;
  result.camera = std::move(camera);
  return result;
}

Result<ForeignMessage> FromTf(foreign::tf2_msgs::TFMessage& message, const Options&) {
  ForeignMessage result;
  for (const auto& stamped : message.transforms) {
    AddEdge("TFMessage", stamped.header.frame_id, stamped.child_frame_id,
            UtimeOf(stamped.header.stamp.sec, stamped.header.stamp.nsec),
            RosPose(stamped.transform.translation, stamped.transform.rotation), &result);
  }
  return result;
}

Result<ForeignMessage> FromPoseStamped(foreign::geometry_msgs::PoseStamped& message,
                                       const Options& options) {
  return OneEdge("PoseStamped", message.header.frame_id, options.body_frame,
                 UtimeOf(message.header.stamp.sec, message.header.stamp.nsec),
                 RosPose(message.pose.position, message.pose.orientation));
}

Result<ForeignMessage> FromOdometry(foreign::nav_msgs::Odometry& message, const Options& options) {
  const std::string& child = message.child_frame_id;
  return OneEdge("Odometry", message.header.frame_id, child.empty() ? options.body_frame : child,
                 UtimeOf(message.header.stamp.sec, message.header.stamp.nsec),
                 RosPose(message.pose.pose.position, message.pose.pose.orientation));
}

// ---- Drake.

enum DrakePixels { kDrakeRgb = 1, kDrakeBgr = 2, kDrakeRgba = 3, kDrakeDepth = 5, kDrakeLabel = 6 };
enum DrakeChannels { kDrakeU8 = 1, kDrakeU16 = 3, kDrakeF32 = 6 };
enum DrakeCompression { kDrakeRaw = 0, kDrakeZlib = 1, kDrakeJpeg = 2, kDrakePng = 3 };

// The format of a raw image, and how many bytes a pixel has; 0 = unknown.
std::pair<PixelFormat, int> DrakeFormat(const foreign::drake::lcmt_image& image) {
  if (image.pixel_format == kDrakeDepth) {
    if (image.channel_type == kDrakeU16) return {PixelFormat::kDepth16, 2};
    if (image.channel_type == kDrakeF32) return {PixelFormat::kDepthFloat, 4};
  } else if (image.channel_type == kDrakeU8) {
    if (image.pixel_format == kDrakeRgb) return {PixelFormat::kRgb, 3};
    if (image.pixel_format == kDrakeBgr) return {PixelFormat::kBgr, 3};
    if (image.pixel_format == kDrakeRgba) return {PixelFormat::kRgba, 4};
  }
  return {PixelFormat::kRgb, 0};
}

Result<ForeignImage> FromDrakeImage(foreign::drake::lcmt_image& image, int64_t utime) {
  ForeignImage result{utime, "", image.width, image.height};
  const bool depth = image.pixel_format == kDrakeDepth;
  const auto [format, pixel_bytes] = DrakeFormat(image);
  if (pixel_bytes == 0) {
    return Fail("lcmt_image: pixel_format " + std::to_string(image.pixel_format) +
                " with channel_type " + std::to_string(image.channel_type) + " is unknown");
  }
  if (image.compression_method == kDrakeJpeg || image.compression_method == kDrakePng) {
    if (depth && (image.compression_method == kDrakeJpeg || format != PixelFormat::kDepth16))
      return Fail("lcmt_image: depth with this channel_type and compression_method is unknown");
    result.format = image.compression_method == kDrakeJpeg ? PixelFormat::kJpeg
                    : depth                                ? PixelFormat::kDepthPng
                                                           : PixelFormat::kPng;
    result.bytes = std::move(image.data);
    return result;
  }
  if (image.compression_method != kDrakeRaw && image.compression_method != kDrakeZlib) {
    return Fail("lcmt_image.compression_method " + std::to_string(image.compression_method) +
                " is unknown");
  }
  result.format = format;
  const int64_t row = int64_t{image.width} * pixel_bytes;
  const int64_t step = image.row_stride == 0 ? row : image.row_stride;
  if (image.compression_method == kDrakeZlib) {
    if (format == PixelFormat::kDepth16 && step == row && image.bigendian == 0) {
      result.format = PixelFormat::kDepth16Zlib;  // is passed on as it is
      result.bytes = std::move(image.data);
      return result;
    }
    if (step <= 0 || image.height <= 0) return Fail("lcmt_image: an impossible size");
    auto plain =
        InflateZlib(image.data, static_cast<size_t>(step) * static_cast<size_t>(image.height));
    if (!plain) return Fail("lcmt_image: " + plain.error().message);
    image.data = std::move(*plain);
  }
  Result<std::vector<uint8_t>> bytes =
      TightRows({image.width, image.height, step, pixel_bytes, depth ? pixel_bytes : 1,
                 image.bigendian != 0, std::move(image.data)});
  if (!bytes) return Fail("lcmt_image: " + bytes.error().message);
  result.bytes = std::move(*bytes);
  return result;
}

Result<ForeignMessage> FromImageArray(foreign::drake::lcmt_image_array& message,
                                      const Options& options) {
  ForeignMessage result;
  for (foreign::drake::lcmt_image& image : message.images) {
    if (image.pixel_format == kDrakeLabel) continue;
    const bool depth = image.pixel_format == kDrakeDepth;
    AddImage(
        depth ? options.depth : options.color,
        [&] { return FromDrakeImage(image, message.header.utime); },
        depth ? &result.depth : &result.color, &result);
  }
  return result;
}

Result<ForeignMessage> FromViewerDraw(foreign::drake::lcmt_viewer_draw& message,
                                      const Options& options) {
  ForeignMessage result;
  if (message.timestamp < 0 || message.timestamp > kLatestUtime / 1000)
    return Fail("lcmt_viewer_draw.timestamp is " + std::to_string(message.timestamp) + " ms");
  for (size_t i = 0; i < message.link_name.size(); ++i) {
    if (message.link_name[i] == options.root) continue;
    const std::vector<float>& p = message.position[i];
    const std::vector<float>& q = message.quaternion[i];
    const std::string& link = message.link_name[i];
    AddEdge("lcmt_viewer_draw", options.root,
            link.empty() ? link : FrameOfRobot(link, message.robot_num[i]),
            message.timestamp * 1000, PoseOf({q[0], q[1], q[2], q[3]}, {p[0], p[1], p[2]}),
            &result);
  }
  return result;
}

// ---- bot_core.

enum BotPixels : int32_t {
  kBotRgb = 859981650,
  kBotBgr = 861030210,
  kBotGrey = 1497715271,
  kBotJpeg = 1196444237,
  kBotGrey16 = 909199180,
};
enum BotImages { kBotLeft = 0, kBotDepth = 4, kBotDepthZipped = 6 };

Result<ForeignImage> FromBotColor(foreign::bot_core::image_t& image) {
  ForeignImage result{image.utime, "", image.width, image.height};
  if (image.pixelformat == kBotJpeg) {
    result.format = PixelFormat::kJpeg;
    result.bytes = std::move(image.data);
    return result;
  }
  int pixel_bytes = 3;
  switch (image.pixelformat) {
    case kBotRgb:
      result.format = PixelFormat::kRgb;
      break;
    case kBotBgr:
      result.format = PixelFormat::kBgr;
      break;
    case kBotGrey:
      result.format = PixelFormat::kGrey;
      pixel_bytes = 1;
      break;
    default:
      return Fail("image_t.pixelformat " + std::to_string(image.pixelformat) + " is unknown");
  }
  Result<std::vector<uint8_t>> bytes = TightRows(
      {image.width, image.height, image.row_stride, pixel_bytes, 1, false, std::move(image.data)});
  if (!bytes) return Fail("image_t: " + bytes.error().message);
  result.bytes = std::move(*bytes);
  return result;
}

// The pixelformat of depth is not reliable.
Result<ForeignImage> FromBotDepth(foreign::bot_core::image_t& image, bool zipped, int64_t utime) {
  ForeignImage result{utime, "", image.width, image.height};
  if (zipped) {
    result.format = PixelFormat::kDepth16Zlib;
    result.bytes = std::move(image.data);
    return result;
  }
  result.format = PixelFormat::kDepth16;
  Result<std::vector<uint8_t>> bytes =
      TightRows({image.width, image.height, 0, 2, 2, false, std::move(image.data)});
  if (!bytes) return Fail("image_t: " + bytes.error().message);
  result.bytes = std::move(*bytes);
  return result;
}

Result<ForeignMessage> FromImages(foreign::bot_core::images_t& message, const Options& options) {
  ForeignMessage result;
  for (size_t i = 0; i < message.images.size(); ++i) {
    const int type = message.image_types[i];
    foreign::bot_core::image_t& image = message.images[i];
    if (type == kBotLeft) {
      AddImage(
          options.color, [&] { return FromBotColor(image); }, &result.color, &result);
    } else if (type == kBotDepth || type == kBotDepthZipped) {
      AddImage(
          options.depth,
          [&] { return FromBotDepth(image, type == kBotDepthZipped, message.utime); },
          &result.depth, &result);
    }
  }
  // The colour image of the message belongs to the depth image, whatever its time.
  if (result.color && result.depth && result.color->utime == 0) result.color->utime = message.utime;
  return result;
}

Result<ForeignMessage> FromImage(foreign::bot_core::image_t& message, const Options& options) {
  const bool depth = options.role == ImageRole::kDepth;
  const bool zipped = message.data.size() != 2 * static_cast<size_t>(std::max(0, message.width)) *
                                                 static_cast<size_t>(std::max(0, message.height));
  Result<ForeignImage> image =
      depth ? FromBotDepth(message, zipped, message.utime) : FromBotColor(message);
  if (!image) return tl::unexpected(image.error());
  return OneImage(std::move(*image), options.role);
}

Result<ForeignMessage> FromBotPose(foreign::bot_core::pose_t& message, const Options& options) {
  const double* q = message.orientation;
  return OneEdge("pose_t", options.root, options.body_frame, message.utime,
                 PoseOf({q[0], q[1], q[2], q[3]}, Eigen::Vector3d(message.pos)));
}

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

// The frame that a part of a channel's name means. bot-frames writes names in capitals there.
std::string FrameInChannel(const std::string& name, const Options& options) {
  for (const std::string* known : {&options.root, &options.body_frame, &options.camera_frame}) {
    if (EqualIgnoringCase(name, *known)) return *known;
  }
  return name;
}

Result<ForeignMessage> FromRigidTransform(foreign::bot_core::rigid_transform_t& message,
                                          const std::string& channel, const Options& options) {
  constexpr std::string_view kTo = "_TO_";
  const size_t to = channel.find(kTo);
  const bool named = to != std::string::npos;
  const double* q = message.quat;
  return OneEdge("rigid_transform_t",
                 named ? FrameInChannel(channel.substr(to + kTo.size()), options) : options.root,
                 named ? FrameInChannel(channel.substr(0, to), options) : options.camera_frame,
                 message.utime, PoseOf({q[0], q[1], q[2], q[3]}, Eigen::Vector3d(message.trans)));
}

// ---- All of them.

constexpr size_t kMostBytes = 64 * kMegabyte;  // of a message with images
constexpr size_t kMostPoseBytes = 4 * kMegabyte;

using Reader = std::function<Result<ForeignMessage>(std::span<const uint8_t>,
                                                    const std::string& channel, const Options&)>;

template <typename Message, typename Convert>
Reader ReaderOf(size_t most_bytes, Convert convert) {
  return [=](std::span<const uint8_t> bytes, const std::string&,
             const Options& options) -> Result<ForeignMessage> {
    Result<Message> message = Unpack<Message>(bytes, most_bytes);
    if (!message) return tl::unexpected(message.error());
    return convert(*message, options);
  };
}

template <typename Message, typename Convert>
void AddReader(size_t most_bytes, Convert convert, std::map<int64_t, Reader>* readers) {
  readers->emplace(Message::getHash(), ReaderOf<Message>(most_bytes, convert));
}

std::map<int64_t, Reader> MakeReaders() {
  std::map<int64_t, Reader> readers;
  AddReader<foreign::sensor_msgs::Image>(kMostBytes, FromRosImage, &readers);
  AddReader<foreign::sensor_msgs::CameraInfo>(kMostPoseBytes, FromCameraInfo, &readers);
  AddReader<foreign::tf2_msgs::TFMessage>(kMostPoseBytes, FromTf, &readers);
  AddReader<foreign::geometry_msgs::PoseStamped>(kMostPoseBytes, FromPoseStamped, &readers);
  AddReader<foreign::nav_msgs::Odometry>(kMostPoseBytes, FromOdometry, &readers);
  AddReader<foreign::drake::lcmt_image_array>(kMostBytes, FromImageArray, &readers);
  AddReader<foreign::drake::lcmt_viewer_draw>(kMostPoseBytes, FromViewerDraw, &readers);
  AddReader<foreign::bot_core::images_t>(kMostBytes, FromImages, &readers);
  AddReader<foreign::bot_core::image_t>(kMostBytes, FromImage, &readers);
  AddReader<foreign::bot_core::pose_t>(kMostPoseBytes, FromBotPose, &readers);
  using Transform = foreign::bot_core::rigid_transform_t;
  readers.emplace(Transform::getHash(),
                  [](std::span<const uint8_t> bytes, const std::string& channel,
                     const Options& options) -> Result<ForeignMessage> {
                    Result<Transform> message = Unpack<Transform>(bytes, kMostPoseBytes);
                    if (!message) return tl::unexpected(message.error());
                    return FromRigidTransform(*message, channel, options);
                  });
  return readers;
}

}  // namespace

int64_t UtimeOf(int32_t sec, int32_t nsec) {
  return int64_t{sec} * 1'000'000 + (int64_t{nsec} + 500) / 1000;
}

Result<void> SetDistortion(const std::string& model, const std::vector<double>& coefficients,
                           ForeignCamera* camera) {
  camera->distortion = ForeignCamera::Distortion::kNone;
  camera->coefficients.clear();
  const bool zero = std::all_of(coefficients.begin(), coefficients.end(),
                                [](double value) { return value == 0; });
  if (zero || model == "none") return {};
  const size_t count = coefficients.size();
  const bool brown = model == "plumb_bob" || model == "rational_polynomial" || model.empty();
  const bool fisheye = model == "equidistant" || model == "kannala_brandt4";
  if (!brown && !fisheye) return Fail("the distortion_model '" + model + "' is unknown");
  if (fisheye ? count != 4 : (count != 4 && count != 5 && count != 8)) {
    return Fail("the distortion_model '" + model + "' has " + std::to_string(count) +
                " coefficients, expected " + (fisheye ? "4" : "4, 5 or 8"));
  }
  camera->distortion =
      fisheye ? ForeignCamera::Distortion::kEquidistant : ForeignCamera::Distortion::kBrownConrady;
  camera->coefficients = coefficients;
  return {};
}

Result<ForeignMessage> DecodeForeign(std::span<const uint8_t> bytes, const std::string& channel,
                                     const ForeignMessageOptions& options) {
  static const std::map<int64_t, Reader> kReaders = MakeReaders();
  if (bytes.size() < 8) return Fail("a message of " + std::to_string(bytes.size()) + " bytes");
  const auto found = kReaders.find(envelope::ReadFingerprint(bytes));
  if (found == kReaders.end())
    return Fail("the type of the message is not one that the adapter reads");
  Result<ForeignMessage> message = found->second(bytes, channel, options);
  if (!message) return message;
  for (const auto* image : {&message->color, &message->depth}) {
    if (*image && (*image)->frame_id.size() > kMostFrameName)
      return Fail("the name of an image's frame has " + std::to_string((*image)->frame_id.size()) +
                  " characters; at most " + std::to_string(kMostFrameName) + " are allowed");
  }
  const bool empty = !message->color && !message->depth && message->edges.empty();
  if (empty && !message->left_out.empty()) return Fail(message->left_out.front());
  return message;
}

}  // namespace vismap
