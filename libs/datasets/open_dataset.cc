#include <algorithm>
#include <array>

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
  FolderDataset(fs::path folder, const char* format, SequenceFiles files, CameraId camera_id)
      : folder_(std::move(folder)), format_(format), files_(std::move(files)), camera_(camera_id) {}

  std::string name() const override { return folder_.filename().string(); }
  std::string format() const override { return format_; }
  size_t size() const override { return files_.frames.size(); }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }

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
    Result<std::vector<uint8_t>> color = ReadColorOf(files_.frames[i].color);
    if (!color) return Fail(color.error().message);
    frame.color_jpeg = std::move(*color);
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
    for (size_t i = 0; i < recorded.size(); i += static_cast<size_t>(options.stride)) {
      if (options.max_frames > 0 && size() == static_cast<size_t>(options.max_frames)) break;
      if (recorded[i].T_W_C) {
        files_.frames.push_back(std::move(recorded[i]));
      } else {
        skipped_.push_back({recorded[i].number, recorded[i].T_W_C.error().message});
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

  fs::path folder_;
  const char* format_;
  SequenceFiles files_;
  CameraId camera_;
  std::vector<SkippedFrame> skipped_;
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
  for (size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].utime > frames[i - 1].utime) continue;
    return Fail(folder.string() + ": expected increasing times, but frame " +
                std::to_string(frames[i].number) + " has utime " + std::to_string(frames[i].utime) +
                ", which is not after " + std::to_string(frames[i - 1].utime) +
                " of the frame before");
  }
  return {};
}

Result<fs::path> CheckFolder(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::canonical(path, error);
  if (error) return Fail(path + ": " + error.message());
  if (!fs::is_directory(folder, error)) return Fail(path + ": expected a folder, found a file");
  return folder;
}

}  // namespace

Result<void> CheckOptions(const DatasetOptions& options) {
  if (options.stride < 1) {
    return Fail("data set options: stride is " + std::to_string(options.stride) +
                "; expected 1 or more");
  }
  if (options.max_frames < 0) {
    return Fail("data set options: max_frames is " + std::to_string(options.max_frames) +
                "; expected 0 or more");
  }
  return {};
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
  if (const auto checked = ValidateCamera(files->camera); !checked) {
    return Fail(folder->string() + ": " + checked.error().message);
  }
  if (const auto checked = CheckTimes(*folder, files->frames); !checked) {
    return Fail(checked.error().message);
  }
  auto dataset = std::make_unique<FolderDataset>(*folder, (*found)->name, std::move(*files),
                                                 options.camera_id);
  dataset->Select(options);
  return dataset;
}

}  // namespace vismap
