#include "datasets/formats.h"

#include <cmath>
#include <map>
#include <set>

#include "datasets/image_file.h"

namespace vismap {

int64_t UtimeAtRate(int64_t number, double rate) {
  return std::llround(static_cast<double>(number) * 1e6 / rate);
}

Result<ImageFileInfo> FirstInfo(const std::vector<FrameFiles>& frames,
                                std::filesystem::path FrameFiles::*image) {
  Result<ImageFileInfo> first = Fail("there is no image");
  bool tried = false;
  for (const FrameFiles& frame : frames) {
    if (!frame.missing.empty()) continue;
    Result<ImageFileInfo> info = ReadImageInfo(frame.*image);
    if (info || !tried) first = std::move(info);
    if (first) break;
    tried = true;
  }
  return first;
}

namespace {

// A negative fy means an image whose y axis points up, hence a left-handed camera and world (those
// of POV-Ray). Mirroring y of both gives a right-handed camera with y down in a right-handed
// world.
void MakeRightHanded(SequenceFiles* files) {
  if (!(files->camera.fy < 0)) return;
  files->camera.fy = -files->camera.fy;
  const Eigen::Vector4d mirror(1, -1, 1, 1);
  for (FrameFiles& frame : files->frames) {
    if (!frame.T_W_C) continue;
    frame.T_W_C = MakePose(mirror.asDiagonal() * frame.T_W_C->matrix() * mirror.asDiagonal());
  }
}

Result<void> CheckAssumedSize(const std::filesystem::path& folder, const KnownCamera& known,
                              const ImageFileInfo& image) {
  if (!known.assumed || (image.width == known.camera.width && image.height == known.camera.height))
    return {};
  return Fail(folder.string() + ": the intrinsics are unknown: the depth images are " +
              SizeText(image.width, image.height) + ", but the values that are " + known.source +
              " hold for " + SizeText(known.camera.width, known.camera.height) +
              "; give them with --intrinsics fx,fy,cx,cy");
}

KnownCamera GivenCamera(const std::array<double, 4>& intrinsics, const KnownCamera& stated) {
  PinholeCamera camera{
      .fx = intrinsics[0], .fy = intrinsics[1], .cx = intrinsics[2], .cy = intrinsics[3]};
  if (!stated.assumed) {
    camera.width = stated.camera.width;
    camera.height = stated.camera.height;
  }
  return {camera, "the option --intrinsics", false};
}

}  // namespace

Result<std::string> ResolveCamera(const std::filesystem::path& folder,
                                  const std::optional<std::array<double, 4>>& intrinsics,
                                  SequenceFiles* files) {
  if (!intrinsics && !files->known_camera) return tl::unexpected(files->known_camera.error());
  KnownCamera known = files->known_camera.value_or(KnownCamera{});
  if (intrinsics) known = GivenCamera(*intrinsics, known);
  files->camera = known.camera;
  if (known.assumed || known.camera.width == 0) {
    const Result<ImageFileInfo> info = FirstInfo(files->frames, &FrameFiles::depth);
    if (!info) return tl::unexpected(info.error());
    if (const auto checked = CheckAssumedSize(folder, known, *info); !checked)
      return tl::unexpected(checked.error());
    files->camera.width = info->width;
    files->camera.height = info->height;
  }
  MakeRightHanded(files);
  if (const auto checked = ValidateCamera(files->camera); !checked)
    return Fail(folder.string() + ": " + checked.error().message);
  return known.source;
}

Result<std::vector<LoggedPose>> ReadTrajectoryLog(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return Fail(text.error().message);
  const std::vector<TextLine> lines = SplitLines(*text);
  std::vector<LoggedPose> poses;
  for (size_t begin = 0; begin < lines.size(); begin += 5) {
    const std::optional<int64_t> index = ParseInteger(lines[begin].words[0]);
    if (!index || lines[begin].words.size() != 3)
      return FailAtLine(path, lines[begin], "three integers \"i i i+1\"");
    if (begin + 5 > lines.size()) {
      return Fail(path.string() + ":" + std::to_string(lines[begin].number) +
                  ": expected four rows of a matrix after this line, found the end of the file");
    }
    std::vector<double> numbers;
    for (size_t row = begin + 1; row < begin + 5; ++row) {
      for (const std::string_view word : lines[row].words) {
        const std::optional<double> number = ParseNumber(word);
        if (!number) return FailAtLine(path, lines[row], "four numbers");
        numbers.push_back(*number);
      }
      if (lines[row].words.size() != 4) return FailAtLine(path, lines[row], "four numbers");
    }
    poses.push_back({*index, MakePose(RowMajor4x4(numbers.data()))});
  }
  return poses;
}

namespace {

constexpr int64_t kMaxFrameNumber = 100'000'000'000;  // so that its time fits into 64 bits

std::string MissingText(const char* kind, const NamePattern& pattern,
                        const std::filesystem::path& partner) {
  return std::string("there is no ") + kind + " image " + pattern.prefix + "N" +
         pattern.suffixes[0] + " with the number of " + partner.filename().string();
}

}  // namespace

Result<std::vector<FrameFiles>> PairByNumber(const NamePattern& color, const NamePattern& depth) {
  const Result<std::vector<NumberedFile>> colors = ListNumberedFiles(color);
  if (!colors) return Fail(colors.error().message);
  const Result<std::vector<NumberedFile>> depths = ListNumberedFiles(depth);
  if (!depths) return Fail(depths.error().message);
  if (colors->empty() && depths->empty()) {
    return Fail(color.folder.string() + ": expected images with names like " + color.prefix + "N" +
                color.suffixes[0] + ", found none");
  }
  std::map<int64_t, FrameFiles> frames;
  for (const NumberedFile& file : *colors) frames[file.number].color = file.path;
  for (const NumberedFile& file : *depths) frames[file.number].depth = file.path;
  std::vector<FrameFiles> sorted;
  for (auto& [number, frame] : frames) {
    const std::filesystem::path& one = frame.depth.empty() ? frame.color : frame.depth;
    if (number > kMaxFrameNumber) {
      return Fail(one.string() + ": the number " + one.stem().string() +
                  " is out of range; expected the number of a frame, at most " +
                  std::to_string(kMaxFrameNumber) + " (is it a time in nanoseconds?)");
    }
    frame.number = number;
    if (frame.depth.empty()) frame.missing = MissingText("depth", depth, frame.color);
    if (frame.color.empty()) frame.missing = MissingText("colour", color, frame.depth);
    sorted.push_back(std::move(frame));
  }
  return sorted;
}

Result<Result<Pose>> ReadPoseFile(const std::filesystem::path& path) {
  const Result<std::vector<double>> numbers = ReadNumbers(path, 16);
  if (!numbers) return Fail(numbers.error().message);
  return MakePose(RowMajor4x4(numbers->data()));
}

}  // namespace vismap
