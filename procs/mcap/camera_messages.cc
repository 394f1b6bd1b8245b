#include "mcap/camera_messages.h"

#include <cstring>
#include <opencv2/imgproc.hpp>

#include "base/printable.h"
#include "codecs/frame_codec.h"
#include "foxglove.pb.h"
#include "mcap/foxglove_fields.h"
#include "render/palette.h"
#include "render/png.h"

namespace vismap {
namespace {

constexpr double kMillimetre = 0.001;
constexpr double kOutlinePixels = 2;

// Of a raw encoding: its name in foxglove.RawImage, and the bytes of a pixel.
struct RawKind {
  const char* name;
  int bytes;
};

RawKind RawKindOf(ColorEncoding encoding) {
  switch (encoding) {
    case ColorEncoding::kRgb:
      return {"rgb8", 3};
    case ColorEncoding::kBgr:
      return {"bgr8", 3};
    case ColorEncoding::kRgba:
      return {"rgba8", 4};
    case ColorEncoding::kBgra:
      return {"bgra8", 4};
    default:
      return {"mono8", 1};
  }
}

const PinholeCamera& ColorCameraOf(const SensorFrame& frame) {
  return frame.optics ? frame.optics->color.pinhole : frame.header.camera;
}

FoxgloveMessage CompressedColor(const SensorFrame& frame, const std::string& frame_id) {
  foxglove::CompressedImage image;
  SetTime(frame.header.utime, image.mutable_timestamp());
  image.set_frame_id(frame_id);
  image.set_format(frame.color_encoding == ColorEncoding::kPng ? "png" : "jpeg");
  image.set_data(frame.color.data(), frame.color.size());
  return EncodeFoxglove(image);
}

FoxgloveMessage RawColor(const SensorFrame& frame, const std::string& frame_id) {
  const RawKind kind = RawKindOf(frame.color_encoding);
  const PinholeCamera& camera = ColorCameraOf(frame);
  foxglove::RawImage image;
  SetTime(frame.header.utime, image.mutable_timestamp());
  image.set_frame_id(frame_id);
  image.set_width(static_cast<uint32_t>(camera.width));
  image.set_height(static_cast<uint32_t>(camera.height));
  image.set_encoding(kind.name);
  image.set_step(static_cast<uint32_t>(camera.width * kind.bytes));
  image.set_data(frame.color.data(), frame.color.size());
  return EncodeFoxglove(image);
}

std::string DistortionName(const LensCamera& camera) {
  if (camera.distortion == Distortion::kNone) return "";
  if (camera.distortion == Distortion::kEquidistant) return "kannala_brandt";
  return camera.coefficients.size() > 5 ? "rational_polynomial" : "plumb_bob";
}

// The outlines of the connected parts of a mask, in pixels of its box.
std::vector<std::vector<cv::Point>> OutlinesOf(const Mask& mask) {
  cv::Mat inside(mask.inside.height(), mask.inside.width(), CV_8U);
  for (int v = 0; v < inside.rows; ++v)
    std::memcpy(inside.ptr(v), mask.inside.row(v), static_cast<size_t>(inside.cols));
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(inside, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  return outlines;
}

void AddOutline(const std::vector<cv::Point>& outline, const Mask& mask,
                foxglove::PointsAnnotation* annotation) {
  annotation->set_type(foxglove::PointsAnnotation::LINE_LOOP);
  annotation->set_thickness(kOutlinePixels);
  for (const cv::Point& corner : outline) {
    foxglove::Point2* point = annotation->add_points();
    point->set_x(mask.u0 + corner.x + 0.5);
    point->set_y(mask.v0 + corner.y + 0.5);
  }
}

std::string DetectionText(const Detection& detection, const ClassNamer& class_name) {
  char score[16];
  std::snprintf(score, sizeof(score), " %.2f", static_cast<double>(detection.score));
  return PrintableText(class_name(detection.class_id)) + score;
}

void AddDetection(const Detection& detection, int64_t utime, const ClassNamer& class_name,
                  foxglove::ImageAnnotations* annotations) {
  const Mask& mask = detection.mask;
  const Rgb8 color = StrongColor(Raw(detection.class_id));
  for (const auto& outline : OutlinesOf(mask)) {
    foxglove::PointsAnnotation* points = annotations->add_points();
    SetTime(utime, points->mutable_timestamp());
    AddOutline(outline, mask, points);
    SetColor(color, 1, points->mutable_outline_color());
    SetColor(color, 0.2, points->mutable_fill_color());
    AddMetadata("class_id", std::to_string(Raw(detection.class_id)), points);
    AddMetadata("score", std::to_string(detection.score), points);
  }
  foxglove::TextAnnotation* text = annotations->add_texts();
  SetTime(utime, text->mutable_timestamp());
  text->mutable_position()->set_x(mask.u0);
  text->mutable_position()->set_y(mask.v0);
  text->set_text(DetectionText(detection, class_name));
  text->set_font_size(14);
  SetColor({255, 255, 255}, 1, text->mutable_text_color());
  SetColor(color, 0.7, text->mutable_background_color());
}

}  // namespace

FoxgloveMessage ColorMessage(const SensorFrame& frame, const std::string& frame_id) {
  const bool file =
      frame.color_encoding == ColorEncoding::kJpeg || frame.color_encoding == ColorEncoding::kPng;
  return file ? CompressedColor(frame, frame_id) : RawColor(frame, frame_id);
}

FoxgloveMessage DepthMessage(const SensorFrame& frame, const std::string& frame_id) {
  const Image<uint16_t> depth = DepthInSteps(DepthInMetres(frame), kMillimetre);
  foxglove::RawImage image;
  SetTime(frame.header.utime, image.mutable_timestamp());
  image.set_frame_id(frame_id);
  image.set_width(static_cast<uint32_t>(depth.width()));
  image.set_height(static_cast<uint32_t>(depth.height()));
  image.set_encoding("16UC1");
  image.set_step(static_cast<uint32_t>(2 * depth.width()));
  image.set_data(depth.data(), 2 * depth.size());
  return EncodeFoxglove(image);
}

FoxgloveMessage CalibrationMessage(const LensCamera& camera, int64_t utime,
                                   const std::string& frame_id) {
  const PinholeCamera& pinhole = camera.pinhole;
  foxglove::CameraCalibration calibration;
  SetTime(utime, calibration.mutable_timestamp());
  calibration.set_frame_id(frame_id);
  calibration.set_width(static_cast<uint32_t>(pinhole.width));
  calibration.set_height(static_cast<uint32_t>(pinhole.height));
  calibration.set_distortion_model(DistortionName(camera));
  for (const double coefficient : camera.coefficients) calibration.add_d(coefficient);
  for (const double k : {pinhole.fx, 0.0, pinhole.cx, 0.0, pinhole.fy, pinhole.cy, 0.0, 0.0, 1.0})
    calibration.add_k(k);
  for (const double r : {1, 0, 0, 0, 1, 0, 0, 0, 1}) calibration.add_r(r);
  for (const double p :
       {pinhole.fx, 0.0, pinhole.cx, 0.0, 0.0, pinhole.fy, pinhole.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    calibration.add_p(p);
  return EncodeFoxglove(calibration);
}

FoxgloveMessage TransformMessage(const std::string& parent, const std::string& child,
                                 const Pose& T_parent_child, int64_t utime) {
  foxglove::FrameTransform transform;
  SetTime(utime, transform.mutable_timestamp());
  transform.set_parent_frame_id(parent);
  transform.set_child_frame_id(child);
  SetVector(T_parent_child.translation(), transform.mutable_translation());
  SetRotation(Eigen::Quaterniond(T_parent_child.linear()), transform.mutable_rotation());
  return EncodeFoxglove(transform);
}

FoxgloveMessage PoseMessage(const Pose& T_W_C, int64_t utime) {
  foxglove::PoseInFrame message;
  SetTime(utime, message.mutable_timestamp());
  message.set_frame_id(kWorldFrame);
  SetPose(T_W_C, message.mutable_pose());
  return EncodeFoxglove(message);
}

FoxgloveMessage PathMessage(std::span<const Pose> T_W_C, int64_t utime) {
  foxglove::PosesInFrame message;
  SetTime(utime, message.mutable_timestamp());
  message.set_frame_id(kWorldFrame);
  for (const Pose& pose : T_W_C) SetPose(pose, message.add_poses());
  return EncodeFoxglove(message);
}

FoxgloveMessage DetectionsMessage(const DetectionSet& set, const ClassNamer& class_name) {
  foxglove::ImageAnnotations annotations;
  SetTime(set.utime, annotations.mutable_timestamp());
  for (const Detection& detection : set.detections)
    if (!detection.mask.inside.empty())
      AddDetection(detection, set.utime, class_name, &annotations);
  return EncodeFoxglove(annotations);
}

FoxgloveMessage SegmentsMessage(const SegmentImage& image, int64_t utime,
                                const std::string& frame_id) {
  Image<Rgb8> picture(image.index.width(), image.index.height());
  std::vector<Rgb8> colors;
  for (int i = 0; i < image.segment_count; ++i)
    colors.push_back(StrongColor(static_cast<uint32_t>(i) + 1));
  for (size_t i = 0; i < picture.size(); ++i) {
    const SegmentIndex segment = image.index.pixels()[i];
    if (segment != SegmentIndex::kNone)
      picture.pixels()[i] = colors[static_cast<size_t>(Raw(segment))];
  }
  const std::vector<uint8_t> png = EncodePng(picture);
  foxglove::CompressedImage message;
  SetTime(utime, message.mutable_timestamp());
  message.set_frame_id(frame_id);
  message.set_format("png");
  message.set_data(png.data(), png.size());
  return EncodeFoxglove(message);
}

FoxgloveMessage NoteMessage(NoteLevel level, const std::string& name, const std::string& text,
                            int64_t utime) {
  foxglove::Log log;
  SetTime(utime, log.mutable_timestamp());
  log.set_level(static_cast<foxglove::Log::Level>(level));
  log.set_name(PrintableText(name));
  log.set_message(PrintableText(text));
  return EncodeFoxglove(log);
}

}  // namespace vismap
