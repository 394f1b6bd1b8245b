#include <charconv>
#include <string_view>

#include "base/require.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {
namespace {

constexpr std::string_view kPrefix = "synthetic:";
constexpr int kOfficeFrames = 400;  // steps of about 0.3 m or 13 degrees

template <typename T>
Result<void> SetNumber(std::string_view key, std::string_view text, T low, T high, auto* value) {
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

Result<void> SetNoise(std::string_view value, SyntheticOptions* options) {
  if (value != "kinect" && value != "none") {
    return Fail("synthetic: noise is \"" + std::string(value) + "\"; expected kinect or none");
  }
  options->noise = value == "kinect";
  return {};
}

Result<void> SetCamera(std::string_view value, SyntheticOptions* options) {
  if (value != "ideal" && value != "realsense") {
    return Fail("synthetic: camera is \"" + std::string(value) + "\"; expected ideal or realsense");
  }
  options->realsense = value == "realsense";
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

/// Removes the part before the next comma, and the comma, from the front of a text. Returns the
/// part.
std::string_view PopPart(std::string_view* text) {
  const std::string_view part = text->substr(0, text->find(','));
  text->remove_prefix(std::min(part.size() + 1, text->size()));
  return part;
}

Result<void> AddMove(std::string_view value, SyntheticOptions* options) {
  const Result<void> changed = AddChange("move", PopPart(&value), options);
  if (!changed) return Fail(changed.error().message + ",DX,DY");
  Eigen::Vector2d by;
  for (double& metres : by) {
    const auto set = SetNumber("move", PopPart(&value), -1000.0, 1000.0, &metres);
    if (!set) return Fail(set.error().message + ", as ID@FRAME,DX,DY");
  }
  if (!value.empty()) return Fail("synthetic: move: expected ID@FRAME,DX,DY, found more after it");
  options->changes.back().moved = by;
  return {};
}

/// Fails if a change is of an object that the scene does not have.
Result<void> CheckChanges(const SyntheticOptions& options) {
  if (options.changes.empty()) return {};
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

Result<void> SetParameter(std::string_view key, std::string_view value, SyntheticOptions* o) {
  if (key == "frames") return SetNumber(key, value, 1, 100000, &o->frames);
  if (key == "width") return SetNumber(key, value, 16, 4096, &o->width);
  if (key == "camera") return SetCamera(value, o);
  if (key == "noise") return SetNoise(value, o);
  if (key == "seed") return SetNumber(key, value, uint64_t{0}, UINT64_MAX, &o->seed);
  if (key == "rate") return SetNumber(key, value, 0.001, 1000.0, &o->rate);
  if (key == "tours") return SetNumber(key, value, 1, 10000, &o->tours);
  if (key == "detection_rate") return SetNumber(key, value, 0.0, 1.0, &o->detection_rate);
  if (key == "class_confusion") return SetNumber(key, value, 0.0, 1.0, &o->class_confusion);
  if (key == "mask_noise") return SetNumber(key, value, 0, 64, &o->mask_noise);
  if (key == "detect_every") return SetNumber(key, value, 1, 100000, &o->detect_every);
  if (key == "pose_noise") return SetNumber(key, value, 0.0, 1.0, &o->pose_noise);
  if (key == "drift") return SetNumber(key, value, 0.0, 0.2, &o->drift);
  if (key == "turn_drift") return SetNumber(key, value, 0.0, 10.0, &o->turn_drift);
  if (key == "depth_noise") return SetNumber(key, value, 0.0, 10.0, &o->depth_noise);
  if (key == "remove" || key == "appear") return AddChange(key, value, o);
  if (key == "move") return AddMove(value, o);
  return Fail("synthetic: unknown parameter \"" + std::string(key) +
              "\"; expected frames, width, camera, noise, seed, rate, tours, detection_rate, "
              "class_confusion, mask_noise, detect_every, pose_noise, drift, turn_drift, "
              "depth_noise, remove, appear, move");
}

/// The shortest text of a number from which the same number is read.
template <typename T>
std::string Text(T value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

}  // namespace

bool IsSyntheticPath(const std::string& path) { return path.starts_with(kPrefix); }

Result<SyntheticOptions> ParseSyntheticPath(const std::string& path) {
  Require(IsSyntheticPath(path), "the path of a computed sequence begins with synthetic:");
  std::string_view rest = std::string_view(path).substr(kPrefix.size());
  const size_t question = std::min(rest.find('?'), rest.size());
  SyntheticOptions options;
  options.scene = rest.substr(0, question);
  if (options.scene != "room" && options.scene != "office") {
    return Fail("synthetic: unknown scene \"" + options.scene + "\"; expected room or office");
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
  if (const Result<void> there = CheckChanges(options); !there) return Fail(there.error().message);
  return options;
}

std::string SyntheticPath(const SyntheticOptions& options) {
  std::string path = std::string(kPrefix) + options.scene + "?frames=" + Text(options.frames) +
                     "&width=" + Text(options.width) +
                     "&noise=" + (options.noise ? "kinect" : "none") +
                     "&seed=" + Text(options.seed) + "&rate=" + Text(options.rate) +
                     "&tours=" + Text(options.tours);
  if (options.realsense) path += "&camera=realsense";
  if (options.detection_rate) path += "&detection_rate=" + Text(*options.detection_rate);
  if (options.mask_noise) path += "&mask_noise=" + Text(*options.mask_noise);
  if (options.drift > 0) path += "&drift=" + Text(options.drift);
  if (options.turn_drift > 0) path += "&turn_drift=" + Text(options.turn_drift);
  for (const SyntheticOptions::Change& change : options.changes) {
    path += std::string(change.moved     ? "&move="
                        : change.appears ? "&appear="
                                         : "&remove=") +
            Text(change.object_id) + "@" + Text(change.frame);
    if (change.moved) path += "," + Text(change.moved->x()) + "," + Text(change.moved->y());
  }
  return path + "&class_confusion=" + Text(options.class_confusion) +
         "&detect_every=" + Text(options.detect_every) + "&pose_noise=" + Text(options.pose_noise) +
         "&depth_noise=" + Text(options.depth_noise);
}

}  // namespace vismap
