#include "viewer/camera_watch.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/class_names.h"
#include "base/printable.h"
#include "codecs/color_codec.h"
#include "codecs/label_codec.h"
#include "codecs/raw_image.h"
#include "wire/channels.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr int kMostColumns = 320;      // of the sampled segments
constexpr size_t kMostJpeg = 1 << 20;  // larger ones are encoded again [bytes]
constexpr int kQuality = 75;
constexpr size_t kMostSegments = 4096;              // told of
constexpr double kJoinPeriod = 2, kJoinTime = 0.1;  // [s]
constexpr int kMostRounds = 8;                      // of reading at a time

using PictureJson = nlohmann::ordered_json;

// [value, length, value, length, ...] row by row over every step-th pixel.
PictureJson RunsOf(const SegmentImage& image, int step, int width, int height) {
  PictureJson runs = PictureJson::array();
  int32_t value = 0;
  int64_t length = 0;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto at = static_cast<int32_t>(image.index(v * step, u * step));
      if (length > 0 && at != value) {
        runs.push_back(value);
        runs.push_back(length);
        length = 0;
      }
      value = at;
      ++length;
    }
  }
  if (length > 0) {
    runs.push_back(value);
    runs.push_back(length);
  }
  return runs;
}

Result<PictureJson> SegmentsOf(const segmented_frame_t& message) {
  const camera_t& camera = CameraOf(message.frame);
  if (camera.width < 1 || camera.height < 1) return Fail("the camera has no pixels");
  const Result<SegmentImage> image =
      DecodeSegmentImage(message.labels, camera.width, camera.height);
  if (!image) return tl::unexpected(image.error());
  const int step = (camera.width + kMostColumns - 1) / kMostColumns;
  const int width = (camera.width + step - 1) / step, height = (camera.height + step - 1) / step;
  PictureJson json{{"width", width},
                   {"height", height},
                   {"runs", RunsOf(*image, step, width, height)},
                   {"list", PictureJson::array()}};
  for (const frame_segment_t& segment : message.segments) {
    if (json["list"].size() >= kMostSegments) break;
    const bool named = segment.class_id > 0 && segment.class_id <= 65535;
    json["list"].push_back({{"pixels", segment.pixels},
                            {"class_id", segment.class_id},
                            {"class_name", named ? ClassName(static_cast<ClassId>(segment.class_id))
                                                 : std::string("unknown")},
                            {"score", segment.score},
                            {"overlap", segment.overlap},
                            {"detection", segment.detection}});
  }
  return json;
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
  PictureJson json{{"camera_id", message.frame.camera_id},
                   {"utime", message.utime},
                   {"width", camera.width},
                   {"height", camera.height}};
  Result<PictureJson> segments = SegmentsOf(message);
  const Result<std::vector<uint8_t>> jpeg = JpegOf(message.frame);
  if (segments) json["segments"] = std::move(*segments);
  if (!jpeg) json["problem"] = PrintableText(jpeg.error().message, 300);
  if (!segments) json["problem"] = PrintableText(segments.error().message, 300);
  return EncodePicture(message.frame.camera_id,
                       json.dump(-1, ' ', false, PictureJson::error_handler_t::replace),
                       jpeg ? *jpeg : std::vector<uint8_t>());
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
  if (cameras_.size() <= Board::kMostPictures) camera.newest = shared;
  if (sink_) sink_(shared);
  changed_ = true;
  return {};
}

}  // namespace vismap
