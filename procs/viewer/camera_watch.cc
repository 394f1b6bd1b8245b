#include "viewer/camera_watch.h"

#include <algorithm>
#include <utility>

#include "base/printable.h"
#include "codecs/color_codec.h"
#include "codecs/label_codec.h"
#include "codecs/raw_image.h"
#include "viewer/segment_picture.h"
#include "wire/channels.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr size_t kMostJpeg = 1 << 20;  // larger ones are encoded again [bytes]
constexpr int kQuality = 75;
constexpr double kJoinPeriod = 2, kJoinTime = 0.1;  // [s]
constexpr int kMostRounds = 8;                      // of reading at a time

Result<SegmentImage> SegmentsOf(const segmented_frame_t& message) {
  const camera_t& camera = CameraOf(message.frame);
  if (camera.width < 1 || camera.height < 1) return Fail("the camera has no pixels");
  return DecodeSegmentImage(message.labels, camera.width, camera.height);
}

std::vector<FrameSegment> ListOf(const segmented_frame_t& message) {
  std::vector<FrameSegment> segments;
  for (const frame_segment_t& segment : message.segments) {
    const bool named = segment.class_id > 0 && segment.class_id <= 65535;
    segments.push_back({segment.pixels, static_cast<DetectionIndex>(segment.detection),
                        named ? static_cast<ClassId>(segment.class_id) : ClassId::kUnknown,
                        segment.score, segment.overlap});
  }
  return segments;
}

}  // namespace

Result<std::vector<uint8_t>> JpegOf(const rgbd_frame_t& frame) {
  if (frame.color_encoding == rgbd_frame_t::COLOR_NONE) return Fail("the frame has no colour");
  if (frame.color_encoding == rgbd_frame_t::COLOR_JPEG && frame.color.size() <= kMostJpeg)
    return frame.color;
  const Result<SensorFrame> sensor = DecodeWithoutDepth(frame);
  if (!sensor) return tl::unexpected(sensor.error());
  const camera_t& camera = CameraOf(frame);
  const auto image =
      DecodeColor(sensor->color_encoding, sensor->color, camera.width, camera.height);
  if (!image) return tl::unexpected(image.error());
  return EncodeJpeg(*image, kQuality);
}

std::vector<uint8_t> MakePicture(const segmented_frame_t& message) {
  const camera_t& camera = CameraOf(message.frame);
  const Result<SegmentImage> image = SegmentsOf(message);
  const Result<std::vector<uint8_t>> jpeg = JpegOf(message.frame);
  const std::string problem = !image  ? PrintableText(image.error().message, 300)
                              : !jpeg ? PrintableText(jpeg.error().message, 300)
                                      : "";
  const std::string text =
      PictureText(message.frame.camera_id, message.utime, camera.width, camera.height,
                  image ? &*image : nullptr, ListOf(message), problem);
  return EncodePicture(message.frame.camera_id, text, jpeg ? *jpeg : std::vector<uint8_t>());
}

CameraWatch::CameraWatch(BusOptions bus_options, Rates rates, Board* board, Sink sink)
    : bus_options_(std::move(bus_options)), rates_(rates), board_(board), sink_(std::move(sink)) {
  bus_options_.connect_timeout = kJoinTime;
}

void CameraWatch::Join(double now) {
  if (now < next_join_) return;
  next_join_ = now + kJoinPeriod;
  Result<std::unique_ptr<Bus>> bus = Bus::Open(bus_options_);
  if (!bus) return;  // the other connection of this process says why
  bus_ = std::move(*bus);
  bus_->Subscribe<segmented_frame_t>(
      kSegmentedFrameChannel, [this](const segmented_frame_t& frame) { return OnFrame(frame); },
      Delivery::kLatest);
}

void CameraWatch::Poll(double now, bool pages, const std::set<int>& pictures) {
  if (!pages) board_->RemovePictures();
  if (pages && !std::exchange(had_pages_, pages)) next_read_ = 0;
  had_pages_ = pages;
  const double hz = pages ? rates_.page_hz : rates_.idle_hz;
  if (hz <= 0 || (bus_ != nullptr && !bus_->connected())) bus_.reset();
  if (hz <= 0) return;
  if (bus_ == nullptr) {
    Join(now);
  } else if (now >= next_read_) {
    next_read_ = now + 1 / hz;
    Read();
  }
  // Also of frames that came before a page wanted them.
  MakePictures(pictures);
  if (!std::exchange(changed_, false)) return;
  std::vector<CameraView> views;
  for (const auto& entry : cameras_) views.push_back(entry.second.view);
  board_->Set(Board::Topic::kCameras, CamerasText(views));
}

void CameraWatch::Read() {
  for (int round = 0; round < kMostRounds && bus_->Spin(0); ++round) {
  }
}

void CameraWatch::MakePictures(const std::set<int>& pictures) {
  for (auto& [id, camera] : cameras_) {
    if (camera.newest == nullptr || !pictures.contains(id)) continue;
    const bool has_it = camera.pictured_utime == camera.newest->utime;
    if (has_it && board_->pictures().contains(id)) continue;
    camera.view.picture = board_->SetPicture(id, MakePicture(*camera.newest));
    camera.pictured_utime = camera.newest->utime;
    changed_ = true;
  }
}

Result<void> CameraWatch::OnFrame(const segmented_frame_t& message) {
  const Result<FrameHeader> header = DecodeHeader(message.frame);
  if (!header) return tl::unexpected(header.error());
  const int id = message.frame.camera_id;
  if (!cameras_.contains(id) && cameras_.size() >= kMostCameras)
    return Fail("more than 64 cameras");
  Camera& camera = cameras_[id];
  camera.view.header = *header;
  camera.view.had_detections = message.had_detections != 0;
  camera.view.detections = static_cast<size_t>(
      std::count_if(message.segments.begin(), message.segments.end(),
                    [](const frame_segment_t& segment) { return segment.detection >= 0; }));
  const auto shared = std::make_shared<const segmented_frame_t>(message);
  if (camera.newest != nullptr || cameras_.size() <= Board::kMostPictures) camera.newest = shared;
  if (sink_) sink_(shared);
  changed_ = true;
  return {};
}

}  // namespace vismap
