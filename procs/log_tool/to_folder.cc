#include <algorithm>
#include <set>

#include "base/format.h"
#include "base/reason_counts.h"
#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "datasets/scenenn_writer.h"
#include "log_tool/convert.h"
#include "rectify/rectifier.h"

namespace vismap {
namespace {

std::string NameOf(const FrameHeader& header) {
  return "the frame of camera " + std::to_string(Raw(header.camera_id)) + ", utime " +
         std::to_string(header.utime);
}

Result<CameraId> ChooseCamera(const Dataset& dataset, std::optional<CameraId> camera) {
  std::set<int32_t> cameras;
  for (size_t i = 0; i < dataset.size(); ++i) cameras.insert(Raw(dataset.Header(i).camera_id));
  if (!camera && cameras.size() == 1) return CameraId{*cameras.begin()};
  if (camera && cameras.contains(Raw(*camera))) return *camera;
  std::string known;
  for (const int32_t id : cameras) known += (known.empty() ? "" : ", ") + std::to_string(id);
  return Fail(dataset.name() + " has frames of cameras " + known +
              "; a folder can store only one of them, so choose it with --camera");
}

// The frames of the camera in order of time, the only order that a folder can store.
std::vector<size_t> FramesInTime(const Dataset& dataset, CameraId camera, ConvertResult* result) {
  std::vector<size_t> frames;
  for (size_t i = 0; i < dataset.size(); ++i) {
    if (dataset.Header(i).camera_id == camera) frames.push_back(i);
  }
  if (frames.size() < dataset.size()) {
    result->lost.push_back(
        FormatCount(static_cast<int64_t>(dataset.size() - frames.size()), "frame") +
        " of other cameras");
  }
  const auto earlier = [&](size_t a, size_t b) {
    return dataset.Header(a).utime < dataset.Header(b).utime;
  };
  if (!std::is_sorted(frames.begin(), frames.end(), earlier)) {
    std::stable_sort(frames.begin(), frames.end(), earlier);
    result->lost.push_back(
        "the order of the frames (they are now sorted by time), so the map will differ");
  }
  return frames;
}

/// Chooses the numbers of the frames for their file names.
class Numbering {
 public:
  Numbering(const Dataset& dataset, const std::vector<size_t>& frames, ConvertResult* result) {
    int64_t last = 0;
    for (const size_t i : frames) {
      const int64_t number = dataset.Header(i).frame_number;
      keeps_ = keeps_ && number > last;
      last = number;
    }
    if (!keeps_) result->lost.push_back("the numbers of the frames (they are now counted from 1)");
  }
  int64_t Next(const FrameHeader& header) {
    ++count_;
    return keeps_ ? header.frame_number : count_;
  }

 private:
  bool keeps_ = true;
  int64_t count_ = 0;
};

struct Losses {
  int64_t without_detector = 0, without_class = 0;
  int64_t rectified = 0, color_as_jpeg = 0, depth_rounded = 0;
};

// A folder has rectified frames with colour as JPEG and depth as integers.
Result<SensorFrame> AsFolderFrame(SensorFrame read, Rectifier* rectifier, Losses* losses) {
  constexpr double kDepthUnit = 0.001;  // of depth in metres [m]
  if (read.color.empty()) return Fail(NameOf(read.header) + " has no colour");
  losses->rectified += read.optics ? 1 : 0;
  Result<SensorFrame> frame = rectifier->Rectify(std::move(read));
  if (!frame) return frame;
  if (frame->color.empty()) return Fail(frame->color_problem);
  if (frame->color_encoding != ColorEncoding::kJpeg) {
    const Result<Image<Rgb8>> color = rectifier->DecodeColor(*frame);
    if (!color) return Fail(NameOf(frame->header) + ": colour: " + color.error().message);
    frame->color = EncodeJpeg(*color);
    frame->color_encoding = ColorEncoding::kJpeg;
    ++losses->color_as_jpeg;
  }
  if (frame->depth.empty()) {
    frame->depth_unit_m = kDepthUnit;
    frame->depth = DepthInSteps(frame->depth_m, kDepthUnit);
    frame->depth_m = {};
    ++losses->depth_rounded;
  }
  return frame;
}

void TellImageLosses(const Losses& losses, ConvertResult* result) {
  const auto tell = [&](int64_t count, const std::string& what) {
    if (count > 0) result->lost.push_back(what + " of " + FormatCount(count, "frame"));
  };
  tell(losses.rectified,
       "the images as they were taken (they are now without distortion, and "
       "depth is registered)");
  tell(losses.color_as_jpeg, "the exact colour (it is now a JPEG)");
  tell(losses.depth_rounded, "parts of a millimetre in the depth");
}

Result<void> AddDetections(const FrameHeader& header, int64_t number,
                           const DetectionSource& detections, SceneNnWriter* writer,
                           Losses* losses) {
  if (!detections.DetectorRan(header)) {
    ++losses->without_detector;
    return {};
  }
  Result<DetectionSet> set = detections.ForFrame(header);
  if (!set) return tl::unexpected(set.error());
  set->frame_number = number;
  losses->without_class += static_cast<int64_t>(std::erase_if(
      set->detections, [](const Detection& d) { return d.class_id == ClassId::kUnknown; }));
  writer->AddDetections(*set);
  return {};
}

// All frames of a folder must have the same intrinsics and depth unit.
Result<void> CheckSame(const SensorFrame& frame, const SensorFrame& first) {
  if (frame.header.camera == first.header.camera && frame.depth_unit_m == first.depth_unit_m)
    return {};
  return Fail(NameOf(frame.header) +
              " has other intrinsics or another depth unit than the first frame");
}

double RateOf(const Dataset& dataset, const std::vector<size_t>& frames) {
  const int64_t span = dataset.Header(frames.back()).utime - dataset.Header(frames.front()).utime;
  return span > 0 ? static_cast<double>(frames.size() - 1) * 1e6 / static_cast<double>(span) : 30;
}

}  // namespace

Result<ConvertResult> WriteFolder(const Dataset& dataset, const DetectionSource* detections,
                                  std::optional<CameraId> camera,
                                  const std::filesystem::path& folder) {
  const Result<CameraId> chosen = ChooseCamera(dataset, camera);
  if (!chosen) return tl::unexpected(chosen.error());
  ConvertResult result;
  const std::vector<size_t> frames = FramesInTime(dataset, *chosen, &result);
  Numbering numbering(dataset, frames, &result);
  SceneNnWriter writer(folder);
  Losses losses;
  ReasonCounts left_out;
  Rectifier rectifier;
  std::optional<SensorFrame> first;
  for (const size_t i : frames) {
    Result<SensorFrame> frame = dataset.Read(i);
    if (frame) frame = AsFolderFrame(std::move(*frame), &rectifier, &losses);
    if (!frame) {
      left_out.Add(frame.error().message);
      continue;
    }
    if (!first) first = *frame;
    if (const Result<void> same = CheckSame(*frame, *first); !same)
      return tl::unexpected(same.error());
    FrameHeader header = frame->header;
    header.frame_number = numbering.Next(frame->header);
    writer.AddFrame(header, frame->depth, {".jpg", std::move(frame->color)});
    if (detections != nullptr) {
      const auto added =
          AddDetections(frame->header, header.frame_number, *detections, &writer, &losses);
      if (!added) return tl::unexpected(added.error());
    }
    ++result.frames;
  }
  const int64_t all = result.frames + left_out.total();
  if (!first) return Fail(dataset.name() + ": " + NoUsableFramesText(left_out, all));
  if (left_out.total() > 0) result.lost.push_back(LeftOutText(left_out, all));
  writer.Write("intrinsic/asus.ini",
               SceneNnIni(first->header.camera, RateOf(dataset, frames), first->depth_unit_m));
  if (const Result<void> finished = writer.Finish(); !finished)
    return tl::unexpected(finished.error());
  TellImageLosses(losses, &result);
  if (losses.without_detector > 0 && losses.without_detector < result.frames) {
    result.lost.push_back("the information that no detector ran on " +
                          FormatCount(losses.without_detector, "frame") +
                          ", so the map will differ");
  }
  if (losses.without_class > 0)
    result.lost.push_back(FormatCount(losses.without_class, "detection") + " without a class");
  return result;
}

}  // namespace vismap
