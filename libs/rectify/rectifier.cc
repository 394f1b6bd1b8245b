#include "rectify/rectifier.h"

#include <algorithm>
#include <utility>

#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "codecs/raw_image.h"
#include "rectify/lens.h"
#include "rectify/rectified_camera.h"
#include "rectify/rectify_color.h"
#include "rectify/rectify_depth.h"

namespace vismap {

/// The tables for the frames of one camera, and what they were made of.
struct RectifyTables {
  FrameOptics optics;
  bool has_color = false;
  PinholeCamera target;
  ColorTable color;
  DepthTable depth;

  size_t bytes() const {
    return color.sources.size() * sizeof(ColorSource) + 3 * depth.rx.size() * sizeof(float);
  }
};

namespace {

constexpr size_t kMaxTableBytes = size_t{128} << 20;
constexpr int kJpegQuality = 95;

bool SameOptics(const FrameOptics& a, const FrameOptics& b) {
  return a.color == b.color && a.depth == b.depth && a.depth_registered == b.depth_registered &&
         a.T_color_depth.matrix() == b.T_color_depth.matrix();
}

// The camera whose pixels depth has.
const LensCamera& DepthLens(const FrameOptics& optics, bool has_color) {
  return has_color && optics.depth_registered ? optics.color : optics.depth;
}

Result<void> CheckFolds(const FrameOptics& optics, bool has_color) {
  if (has_color) {
    if (const auto color = CheckOneToOne(optics.color); !color)
      return Fail("color_camera: " + color.error().message);
    if (optics.depth_registered) return {};
  }
  if (const auto depth = CheckOneToOne(optics.depth); !depth)
    return Fail("depth_camera: " + depth.error().message);
  return {};
}

Result<std::shared_ptr<const RectifyTables>> MakeTables(const SensorFrame& frame) {
  auto tables = std::make_shared<RectifyTables>();
  tables->optics = *frame.optics;
  tables->has_color = !frame.color.empty();
  tables->target = frame.header.camera;
  const FrameOptics& optics = tables->optics;
  if (const auto checked = CheckFolds(optics, tables->has_color); !checked)
    return tl::unexpected(checked.error());
  const bool moves = tables->has_color && !optics.depth_registered;
  tables->depth = MakeDepthTable(DepthLens(optics, tables->has_color),
                                 moves ? optics.T_color_depth : Pose::Identity(), tables->target);
  if (tables->has_color) tables->color = MakeColorTable(optics.color, tables->target);
  return std::shared_ptr<const RectifyTables>(std::move(tables));
}

Result<void> CheckDepthSize(const SensorFrame& frame, const PinholeCamera& camera) {
  const bool floats = frame.depth.empty();
  const int width = floats ? frame.depth_m.width() : frame.depth.width();
  const int height = floats ? frame.depth_m.height() : frame.depth.height();
  if (width == camera.width && height == camera.height) return {};
  return Fail("depth is " + std::to_string(width) + "x" + std::to_string(height) +
              ", but its camera " + std::to_string(camera.width) + "x" +
              std::to_string(camera.height));
}

Result<void> RectifyDepthOf(const RectifyTables& tables, SensorFrame* frame) {
  const PinholeCamera& camera = DepthLens(tables.optics, tables.has_color).pinhole;
  if (const auto size = CheckDepthSize(*frame, camera); !size) return size;
  Image<float> depth = RectifyDepth(DepthInMetres(*frame), tables.depth);
  if (frame->depth.empty()) {
    frame->depth_m = std::move(depth);
  } else {
    frame->depth = DepthInSteps(depth, frame->depth_unit_m);
  }
  return {};
}

Result<Image<Rgb8>> RectifyColorOf(const RectifyTables& tables, const SensorFrame& frame) {
  const PinholeCamera& camera = tables.optics.color.pinhole;
  const Result<Image<Rgb8>> color =
      DecodeColor(frame.color_encoding, frame.color, camera.width, camera.height);
  if (!color) return color;
  return RectifyColor(*color, tables.color);
}

}  // namespace

Rectifier::Rectifier() = default;
Rectifier::~Rectifier() = default;

Result<std::shared_ptr<const RectifyTables>> Rectifier::TablesOf(const SensorFrame& frame) {
  const bool has_color = !frame.color.empty();
  const auto known = std::find_if(tables_.begin(), tables_.end(), [&](const auto& tables) {
    return tables->has_color == has_color && tables->target == frame.header.camera &&
           SameOptics(tables->optics, *frame.optics);
  });
  if (known != tables_.end()) {
    std::rotate(known, known + 1, tables_.end());
    return tables_.back();
  }
  auto made = MakeTables(frame);
  if (!made) return made;
  size_t bytes = (*made)->bytes();
  for (const auto& tables : tables_) bytes += tables->bytes();
  for (; !tables_.empty() && bytes > kMaxTableBytes; tables_.pop_front())
    bytes -= tables_.front()->bytes();
  tables_.push_back(*made);
  return made;
}

Result<SensorFrame> Rectifier::Rectify(SensorFrame frame) {
  if (!frame.optics) return frame;
  const auto tables = TablesOf(frame);
  if (!tables) return Fail(FrameText(frame.header) + tables.error().message);
  if (const auto depth = RectifyDepthOf(**tables, &frame); !depth)
    return Fail(FrameText(frame.header) + depth.error().message);
  if ((*tables)->has_color) {
    const Result<Image<Rgb8>> color = RectifyColorOf(**tables, frame);
    if (!color) frame.color_problem = FrameText(frame.header) + "colour: " + color.error().message;
    frame.color = color ? EncodeJpeg(*color, kJpegQuality) : std::vector<uint8_t>();
    frame.color_encoding = ColorEncoding::kJpeg;
  }
  frame.optics.reset();
  return frame;
}

Result<RgbdFrame> Rectifier::Decode(const SensorFrame& frame) {
  if (!frame.optics) return DecodeFrame(frame);
  const Result<SensorFrame> rectified = Rectify(frame);
  if (!rectified) return tl::unexpected(rectified.error());
  return DecodeFrame(*rectified);
}

Result<Image<Rgb8>> Rectifier::DecodeColor(const SensorFrame& frame) {
  if (frame.color.empty()) return Fail("the frame has no colour");
  const PinholeCamera& camera = frame.header.camera;
  if (!frame.optics)
    return vismap::DecodeColor(frame.color_encoding, frame.color, camera.width, camera.height);
  const auto tables = TablesOf(frame);
  if (!tables) return tl::unexpected(tables.error());
  return RectifyColorOf(**tables, frame);
}

}  // namespace vismap
