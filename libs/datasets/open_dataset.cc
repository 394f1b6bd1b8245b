#include <algorithm>
#include <array>
#include <cstdio>

#include "base/reason_counts.h"
#include "base/require.h"
#include "codecs/color_codec.h"
#include "datasets/dataset.h"
#include "datasets/formats.h"
#include "datasets/image_file.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

// Formats are recognised in this order: those with the most specific files first.
constexpr std::array<const DatasetFormat*, 7> kFormats{
    &kSceneNnFormat, &kSevenScenesFormat, &kIclFormat,    &kTumFormat,
    &kScanNetFormat, &kRedwoodFormat,     &kReplicaFormat};

/// The usable frames of a sequence's folder.
class FolderDataset : public Dataset {
 public:
  FolderDataset(fs::path folder, const char* format, SequenceFiles files, CameraId camera_id,
                std::vector<std::string> remarks)
      : folder_(std::move(folder)),
        format_(format),
        files_(std::move(files)),
        camera_(camera_id),
        remarks_(std::move(remarks)) {}

  std::string name() const override { return folder_.filename().string(); }
  std::string format() const override { return format_; }
  size_t size() const override { return files_.frames.size(); }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::vector<std::string> remarks() const override { return remarks_; }
  double depth_unit_m() const override { return files_.depth_unit_m; }
  bool has_clock() const override { return files_.has_clock; }

  FrameHeader Header(size_t i) const override {
    Require(i < size(), "the index of a frame is below the number of frames");
    const FrameFiles& frame = files_.frames[i];
    return {.utime = frame.utime,
            .camera_id = camera_,
            .frame_number = frame.number,
            .camera = files_.camera,
            .T_W_C = *frame.T_W_C};
  }

  Result<SensorFrame> Read(size_t i) const override {
    SensorFrame frame;
    frame.header = Header(i);
    frame.depth_unit_m = files_.depth_unit_m;
    Result<Image<uint16_t>> depth = ReadDepthOf(files_.frames[i].depth);
    if (!depth) return Fail(depth.error().message);
    frame.depth = std::move(*depth);
    const fs::path& path = files_.frames[i].color;
    Result<std::vector<uint8_t>> color = ReadColorOf(path);
    if (color) {
      frame.color = std::move(*color);
    } else if (frame.header.frame_number == last_number_ && IsCutOff(path)) {
      return Fail(color.error().message + " (it is the last image)");
    } else if (HasOtherSize(path)) {
      return Fail(color.error().message);
    } else {
      frame.color_problem = color.error().message;
    }
    return frame;
  }

  std::optional<std::string> default_detections_path() const override {
    const fs::path path = folder_ / "detections.json";
    return fs::exists(path) ? std::optional(path.string()) : std::nullopt;
  }

  /// Keeps only the frames that `options` selects and that can be used.
  void Select(const DatasetOptions& options) {
    std::vector<FrameFiles> recorded;
    recorded.swap(files_.frames);
    last_number_ = recorded.back().number;
    for (size_t i = 0; i < recorded.size(); i += static_cast<size_t>(options.stride)) {
      if (options.max_frames > 0 && size() == static_cast<size_t>(options.max_frames)) break;
      if (!recorded[i].missing.empty()) {
        skipped_.push_back({recorded[i].number, recorded[i].missing});
      } else if (!recorded[i].T_W_C) {
        skipped_.push_back({recorded[i].number, recorded[i].T_W_C.error().message});
      } else {
        files_.frames.push_back(std::move(recorded[i]));
      }
    }
  }

 private:
  Result<Image<uint16_t>> ReadDepthOf(const fs::path& path) const {
    const PinholeCamera& recorded = files_.depth_from ? files_.depth_from->camera : files_.camera;
    Result<Image<uint16_t>> depth = ReadPng16(path, recorded.width, recorded.height);
    if (!depth) return Fail(depth.error().message);
    // Kinects write 65535 for "no return"; the rest of the code expects 0.
    std::replace(depth->pixels().begin(), depth->pixels().end(), uint16_t{65535}, uint16_t{0});
    if (!files_.depth_from) return depth;
    return RegisterDepth(*depth, files_.depth_unit_m, *files_.depth_from, files_.camera);
  }

  Result<std::vector<uint8_t>> ReadColorOf(const fs::path& path) const {
    const PinholeCamera& camera = files_.camera;
    if (!files_.color_camera) return ReadColorAsJpeg(path, camera.width, camera.height);
    const PinholeCamera& from = *files_.color_camera;
    const Result<Image<Rgb8>> color = ReadColor(path, from.width, from.height);
    if (!color) return Fail(color.error().message);
    return EncodeJpeg(ResampleColor(*color, from, camera));
  }

  // Whether a colour image has not the size of the others: not damage, but another camera.
  bool HasOtherSize(const fs::path& path) const {
    const PinholeCamera& camera = files_.color_camera ? *files_.color_camera : files_.camera;
    const Result<ImageFileInfo> info = ReadImageInfo(path);
    return info && (info->width != camera.width || info->height != camera.height);
  }

  fs::path folder_;
  const char* format_;
  SequenceFiles files_;
  CameraId camera_;
  int64_t last_number_ = -1;  // of the last recorded frame
  std::vector<SkippedFrame> skipped_;
  std::vector<std::string> remarks_;
};

Result<const DatasetFormat*> FindFormat(const fs::path& folder, const std::string& name) {
  std::string known;
  for (const DatasetFormat* format : kFormats) {
    if (name == format->name || (name.empty() && format->recognise(folder))) return format;
    known += std::string(known.empty() ? "" : "; ") + format->name + ": " + format->looks_like;
  }
  if (name.empty())
    return Fail(folder.string() + ": no known sequence in this folder; expected one of: " + known);
  return Fail("unknown data set format \"" + name + "\"; expected one of: " + known);
}

/// Fails unless the times of the frames increase.
Result<void> CheckTimes(const fs::path& folder, const std::vector<FrameFiles>& frames) {
  const FrameFiles* last = nullptr;
  for (const FrameFiles& frame : frames) {
    if (!frame.missing.empty()) continue;
    if (last != nullptr && frame.utime <= last->utime) {
      return Fail(folder.string() + ": expected increasing times, but frame " +
                  std::to_string(frame.number) + " has utime " + std::to_string(frame.utime) +
                  ", which is not after " + std::to_string(last->utime) + " of the frame before");
    }
    last = &frame;
  }
  return {};
}

// Whether pixels without a return are 65535, as a Kinect's infrared camera has them.
bool HasKinectHoles(const SequenceFiles& files) {
  for (const FrameFiles& frame : files.frames) {
    const Result<Image<uint16_t>> depth =
        ReadPng16(frame.depth, files.camera.width, files.camera.height);
    if (!depth) continue;  // missing or damaged
    return std::find(depth->pixels().begin(), depth->pixels().end(), 65535) !=
           depth->pixels().end();
  }
  return false;
}

// Registers depth of a Kinect if the options or the sequence say that it is not. Returns what was
// done, for the log.
Result<std::string> ApplyRegistration(DepthRegistration registration, SequenceFiles* files) {
  const bool found = registration == DepthRegistration::kAuto && files->may_be_kinect_depth &&
                     (files->named_as_seven_scenes || HasKinectHoles(*files));
  if (!found && registration != DepthRegistration::kKinect)
    return "depth counts as registered to colour";
  if (const auto registered = RegisterKinectDepth(files); !registered)
    return tl::unexpected(registered.error());
  return std::string(
             "depth is registered from a Kinect's infrared camera to its colour camera with "
             "the nominal calibration, ") +
         (found ? "since its intrinsics, and its pixels of 65535 or its folder's name, are those "
                  "of the "
                  "original 7-Scenes"
                : "as the options say");
}

// Sets camera, depth unit and registration as the options and the sequence say. Returns how, one
// sentence each.
Result<std::vector<std::string>> ApplyCalibration(const fs::path& folder,
                                                  const DatasetOptions& options,
                                                  SequenceFiles* files) {
  const Result<std::string> source = ResolveCamera(folder, options.intrinsics, files);
  if (!source) return tl::unexpected(source.error());
  const bool stated = !options.intrinsics && !files->known_camera->assumed;
  std::vector<std::string> remarks{CameraText(files->camera) + ": " + (stated ? "from " : "") +
                                   *source};
  std::array<char, 256> text{};
  if (options.depth_unit_m > 0) {
    files->depth_unit_m = options.depth_unit_m;
    files->depth_unit_source = "the option --depth-unit";
  }
  std::snprintf(text.data(), text.size(), "depth unit %.6g m: from ", files->depth_unit_m);
  remarks.push_back(text.data() + files->depth_unit_source);
  const Result<std::string> registration = ApplyRegistration(options.registration, files);
  if (!registration) return Fail(folder.string() + ": " + registration.error().message);
  remarks.push_back(*registration);
  return remarks;
}

Result<fs::path> CheckFolder(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(path, error);
  if (error) return Fail(path + ": " + error.message());
  if (!fs::is_directory(folder, error)) return Fail(path + ": expected a folder, found a file");
  return folder;
}

// Why no frame is left.
std::string NoUsableFrames(const Dataset& dataset) {
  ReasonCounts reasons;
  for (const SkippedFrame& skipped : dataset.skipped()) reasons.Add(skipped.reason);
  return NoUsableFramesText(reasons, reasons.total());
}

}  // namespace

Result<void> CheckOptions(const DatasetOptions& options) {
  if (!(options.depth_unit_m >= 0 && options.depth_unit_m <= 1)) {
    return Fail("data set options: the depth unit is " + std::to_string(options.depth_unit_m) +
                " m; expected metres per step, at most 1");
  }
  if (options.stride >= 1 && options.max_frames >= 0) return {};
  return Fail("data set options: stride is " + std::to_string(options.stride) +
              " (expected 1 or more), max_frames is " + std::to_string(options.max_frames) +
              " (expected 0 or more)");
}

Result<std::unique_ptr<Dataset>> OpenDataset(const std::string& path, const std::string& format,
                                             const DatasetOptions& options) {
  if (const auto checked = CheckOptions(options); !checked) return Fail(checked.error().message);
  const Result<fs::path> folder = CheckFolder(path);
  if (!folder) return Fail(folder.error().message);
  const Result<const DatasetFormat*> found = FindFormat(*folder, format);
  if (!found) return Fail(found.error().message);
  Result<SequenceFiles> files = (*found)->list(*folder);
  if (!files) return Fail(files.error().message);
  const auto remarks = ApplyCalibration(*folder, options, &*files);
  if (!remarks) return tl::unexpected(remarks.error());
  if (const auto checked = CheckTimes(*folder, files->frames); !checked) {
    return Fail(checked.error().message);
  }
  auto dataset = std::make_unique<FolderDataset>(*folder, (*found)->name, std::move(*files),
                                                 options.camera_id, *remarks);
  dataset->Select(options);
  if (dataset->size() == 0) return Fail(folder->string() + ": " + NoUsableFrames(*dataset));
  return dataset;
}

}  // namespace vismap
