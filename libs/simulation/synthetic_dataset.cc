#include "simulation/synthetic_dataset.h"

#include <charconv>
#include <cmath>
#include <string_view>

#include "base/require.h"
#include "simulation/office.h"
#include "simulation/room.h"

namespace vismap {
namespace {

constexpr std::string_view kPrefix = "synthetic:";
constexpr int kOfficeFrames = 400;  // steps of about 0.3 m, or 13 degrees where the view turns

template <typename T>
Result<void> SetNumber(std::string_view key, std::string_view text, T low, T high, T* value) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !(number >= low) ||
      !(number <= high)) {
    return Fail("synthetic: " + std::string(key) + " is \"" + std::string(text) + "\"; expected " +
                std::to_string(low) + ".." + std::to_string(high));
  }
  *value = number;
  return {};
}

Result<void> AddChange(std::string_view key, std::string_view value, SyntheticOptions* options) {
  SyntheticOptions::Change change{.appears = key == "appear"};
  const size_t at = std::min(value.find('@'), value.size());
  const std::string_view frame = value.substr(std::min(at + 1, value.size()));
  const auto id_set =
      SetNumber(key, value.substr(0, at), uint16_t{1}, uint16_t{65535}, &change.object_id);
  if (!id_set) return Fail(id_set.error().message + ", as ID@FRAME");
  const auto frame_set = SetNumber(key, frame, int64_t{1}, int64_t{1000000000}, &change.frame);
  if (!frame_set) return Fail(frame_set.error().message + ", as ID@FRAME");
  options->changes.push_back(change);
  return {};
}

// All objects that come or go must be there.
Result<void> CheckChanges(const SyntheticOptions& options) {
  const Scene scene = MakeScene(options);
  for (const SyntheticOptions::Change& change : options.changes) {
    if (FindObject(scene, change.object_id) == nullptr) {
      return Fail("synthetic: " + options.scene + " has no object " +
                  std::to_string(change.object_id) + "; its objects are 1.." +
                  std::to_string(scene.objects.size()));
    }
  }
  return {};
}

Result<void> SetParameter(std::string_view key, std::string_view value, SyntheticOptions* options) {
  if (key == "frames") return SetNumber(key, value, 1, 100000, &options->frames);
  if (key == "width") return SetNumber(key, value, 16, 4096, &options->width);
  if (key == "rate") return SetNumber(key, value, 0.001, 1000.0, &options->rate);
  if (key == "tours") return SetNumber(key, value, 1, 10000, &options->tours);
  if (key == "seed") return SetNumber(key, value, uint64_t{0}, UINT64_MAX, &options->seed);
  if (key == "remove" || key == "appear") return AddChange(key, value, options);
  if (key != "noise") {
    return Fail("synthetic: unknown parameter \"" + std::string(key) +
                "\"; known are frames, width, noise, seed, rate, tours, remove, appear");
  }
  if (value != "kinect" && value != "none") {
    return Fail("synthetic: noise is \"" + std::string(value) + "\"; expected kinect or none");
  }
  options->noise = value == "kinect";
  return {};
}

std::string PathOf(const SyntheticOptions& options) {
  std::string path =
      std::string(kPrefix) + options.scene + "?frames=" + std::to_string(options.frames) +
      "&width=" + std::to_string(options.width) + "&noise=" + (options.noise ? "kinect" : "none") +
      "&seed=" + std::to_string(options.seed) + "&rate=" + std::to_string(options.rate) +
      "&tours=" + std::to_string(options.tours);
  for (const SyntheticOptions::Change& change : options.changes) {
    path += std::string(change.appears ? "&appear=" : "&remove=") +
            std::to_string(change.object_id) + "@" + std::to_string(change.frame);
  }
  return path;
}

class SyntheticDataset : public Dataset {
 public:
  SyntheticDataset(const SyntheticOptions& options, const DatasetOptions& selection)
      : options_(options), scene_(MakeScene(options)) {
    noise_.enabled = options.noise;
    noise_.seed = options.seed;
    Require(selection.stride >= 1, "the stride of a data set is at least 1");
    const std::vector<FrameHeader> all = MakeHeaders(options);
    for (size_t i = 0; i < all.size(); i += static_cast<size_t>(selection.stride)) {
      if (selection.max_frames > 0 && size() == static_cast<size_t>(selection.max_frames)) break;
      headers_.push_back(all[i]);
      headers_.back().camera_id = selection.camera_id;
    }
  }

  std::string name() const override { return options_.scene; }
  std::string format() const override { return "synthetic"; }
  size_t size() const override { return headers_.size(); }
  FrameHeader Header(size_t i) const override {
    Require(i < size(), "the index of a frame is below the number of frames");
    return headers_[i];
  }
  Result<SensorFrame> Read(size_t i) const override {
    const FrameHeader header = Header(i);
    return RenderFrame(SceneInFrame(scene_, header.frame_number), header, noise_);
  }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override { return PathOf(options_); }

 private:
  SyntheticOptions options_;
  Scene scene_;
  DepthNoise noise_;
  std::vector<FrameHeader> headers_;
  std::vector<SkippedFrame> skipped_;
};

class SyntheticDetections : public DetectionSource {
 public:
  explicit SyntheticDetections(const SyntheticOptions& options)
      : scene_(MakeScene(options)), headers_(MakeHeaders(options)) {
    noise_.seed = options.seed;
    if (!options.noise) noise_.miss_rate = noise_.max_mask_error = 0;
  }

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override {
    if (header.frame_number < 1 || header.frame_number > static_cast<int64_t>(headers_.size())) {
      return DetectionSet{header.utime, header.camera_id, header.frame_number, {}};
    }
    const FrameHeader& truth = headers_[static_cast<size_t>(header.frame_number - 1)];
    if (header.camera != truth.camera) {
      return Fail("synthetic detections: the frame's camera is " +
                  std::to_string(header.camera.width) + "x" + std::to_string(header.camera.height) +
                  ", not that of the sequence, " + std::to_string(truth.camera.width) + "x" +
                  std::to_string(truth.camera.height));
    }
    const Scene shown = SceneInFrame(scene_, header.frame_number);
    return SimulateDetections(shown, RenderInstances(shown, truth.camera, truth.T_W_C), header,
                              noise_);
  }

  int64_t size() const override { return -1; }

 private:
  Scene scene_;
  std::vector<FrameHeader> headers_;
  DetectorNoise noise_;
};

}  // namespace

bool IsSyntheticPath(const std::string& path) { return path.starts_with(kPrefix); }

Result<SyntheticOptions> ParseSyntheticPath(const std::string& path) {
  Require(IsSyntheticPath(path), "the path of a computed sequence begins with synthetic:");
  std::string_view rest = std::string_view(path).substr(kPrefix.size());
  const size_t question = std::min(rest.find('?'), rest.size());
  SyntheticOptions options;
  options.scene = rest.substr(0, question);
  if (options.scene != "room" && options.scene != "office") {
    return Fail("synthetic: unknown scene \"" + options.scene + "\"; known are room, office");
  }
  if (options.scene == "office") options.frames = kOfficeFrames;
  rest.remove_prefix(std::min(question + 1, rest.size()));
  while (!rest.empty()) {
    const std::string_view parameter = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(parameter.size() + 1, rest.size()));
    const size_t equals = std::min(parameter.find('='), parameter.size());
    const std::string_view value = parameter.substr(std::min(equals + 1, parameter.size()));
    const Result<void> set = SetParameter(parameter.substr(0, equals), value, &options);
    if (!set) return Fail(set.error().message);
  }
  if (const auto checked = CheckChanges(options); !checked) return Fail(checked.error().message);
  return options;
}

Scene MakeScene(const SyntheticOptions& options) {
  Require(options.scene == "room" || options.scene == "office", "the scenes are room and office");
  Scene scene = options.scene == "room" ? MakeRoom() : MakeOffice();
  for (const SyntheticOptions::Change& change : options.changes) {
    for (SceneObject& object : scene.objects) {
      if (object.id != change.object_id) continue;
      (change.appears ? object.first_frame : object.end_frame) = change.frame;
    }
  }
  return scene;
}

std::vector<FrameHeader> MakeHeaders(const SyntheticOptions& options) {
  const int height = options.width * 3 / 4;
  const double focal = 525.0 * options.width / 640;
  const PinholeCamera camera{options.width,     height, focal, focal, 0.5 * (options.width - 1),
                             0.5 * (height - 1)};
  std::vector<FrameHeader> headers;
  const std::vector<Pose> tour =
      options.scene == "room" ? MakeRoomTour(options.frames) : MakeOfficeWalk(options.frames);
  const size_t count = tour.size() * static_cast<size_t>(options.tours);
  headers.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const auto number = static_cast<int64_t>(i + 1);
    headers.push_back({.utime = std::llround(static_cast<double>(number) * 1e6 / options.rate),
                       .camera_id = CameraId{0},
                       .frame_number = number,
                       .camera = camera,
                       .T_W_C = tour[i % tour.size()]});
  }
  return headers;
}

std::unique_ptr<Dataset> MakeSyntheticDataset(const SyntheticOptions& options,
                                              const DatasetOptions& selection) {
  return std::make_unique<SyntheticDataset>(options, selection);
}

std::unique_ptr<DetectionSource> MakeSyntheticDetections(const SyntheticOptions& options) {
  return std::make_unique<SyntheticDetections>(options);
}

}  // namespace vismap
