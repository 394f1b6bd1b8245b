#include "simulation/export_scenenn.h"

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "base/file.h"
#include "codecs/mask_codec.h"
#include "simulation/tessellate.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr double kMeshSpacing = 0.03;
constexpr int kSeenPixels = 50;  // an object counts as seen in a frame from so many pixels on

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::vector<uint8_t> Png16(const Image<uint16_t>& image) {
  std::vector<uint8_t> bytes;
  cv::imencode(
      ".png", cv::Mat(image.height(), image.width(), CV_16UC1, const_cast<uint16_t*>(image.data())),
      bytes);
  return bytes;
}

std::vector<uint8_t> PngColor(const Image<Rgb8>& image) {
  cv::Mat bgr(image.height(), image.width(), CV_8UC3);
  for (size_t i = 0; i < image.size(); ++i) {
    const Rgb8 pixel = image.data()[i];
    uint8_t* target = bgr.data + 3 * i;
    target[0] = pixel.b;
    target[1] = pixel.g;
    target[2] = pixel.r;
  }
  std::vector<uint8_t> bytes;
  cv::imencode(".png", bgr, bytes);
  return bytes;
}

/// Writes files below a folder and remembers the first failure.
class Writer {
 public:
  explicit Writer(fs::path folder) : folder_(std::move(folder)) {}

  template <typename Content>
  void Write(const fs::path& name, const Content& content) {
    if (!status_) return;
    std::error_code error;
    fs::create_directories((folder_ / name).parent_path(), error);
    status_ = WriteFileAtomically(folder_ / name, content);
  }
  void WriteBytes(const fs::path& name, const std::vector<uint8_t>& bytes) {
    Write(name, std::span<const uint8_t>(bytes));
  }
  void WriteText(const fs::path& name, const std::string& text) {
    Write(name, std::string_view(text));
  }
  const Result<void>& status() const { return status_; }

 private:
  fs::path folder_;
  Result<void> status_;
};

std::string IniText(const PinholeCamera& camera, double rate) {
  return Format(
      "depth_width %d\ndepth_height %d\ndepth_fps %.17g\nfx %.17g\nfy %.17g\ncx %.17g\ncy %.17g\n",
      camera.width, camera.height, rate, camera.fx, camera.fy, camera.cx, camera.cy);
}

std::string PoseText(int64_t index, const Pose& pose) {
  const long long i = index;
  std::string text = Format("%lld %lld %lld\n", i, i, i + 1);
  for (int row = 0; row < 4; ++row) {
    text += Format("%.17g %.17g %.17g %.17g\n", pose.matrix()(row, 0), pose.matrix()(row, 1),
                   pose.matrix()(row, 2), pose.matrix()(row, 3));
  }
  return text;
}

void AppendDetections(const DetectionSet& set, nlohmann::json* results) {
  for (const Detection& detection : set.detections) {
    const Mask& mask = detection.mask;
    results->push_back({{"image_id", set.frame_number},
                        {"category_id", Raw(detection.class_id)},
                        {"score", detection.score},
                        {"bbox", {mask.u0, mask.v0, mask.inside.width(), mask.inside.height()}},
                        {"segmentation",
                         {{"size", {mask.image_height, mask.image_width}},
                          {"counts", RunsToString(EncodeMask(mask))}}}});
  }
}

/// The names that SceneNN's annotations use for what COCO calls differently.
std::string KindOf(const std::string& name) {
  static const std::map<std::string, std::string> kKinds{
      {"couch", "sofa"},         {"dining table", "table"}, {"book", "books"},
      {"potted plant", "plant"}, {"backpack", "bag"},       {"box", "boxes"},
      {"small box", "boxes"}};
  const auto found = kKinds.find(name);
  return found == kKinds.end() ? name : found->second;
}

std::string XmlText(const Scene& scene, std::map<uint16_t, int> frames, const LabelledMesh& mesh) {
  std::map<uint16_t, int> vertices;
  for (const uint16_t id : mesh.object_ids) ++vertices[id];
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<annotation>\n";
  for (const SceneObject& object : scene.objects) {
    const Eigen::AlignedBox3d box = BoundingBox(object);
    const std::string kind = KindOf(object.name);
    const bool unknown = object.kind == ObjectKind::kUnknown;
    text += Format(
        "  <label id=\"%d\" color=\"%d %d %d\" text=\"%s\" kind=\"%s\" nyu_class=\"%s\" "
        "coco_id=\"%d\" frames=\"%d\" vertices=\"%d\" aabbox=\"%g %g %g %g %g %g\"/>\n",
        object.id, object.color.r, object.color.g, object.color.b,
        unknown ? "unknown" : object.name.c_str(), kind.c_str(), kind.c_str(),
        int{Raw(object.class_id)}, frames[object.id], vertices[object.id], box.min().x(),
        box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z());
  }
  return text + "</annotation>\n";
}

template <typename T>
void AppendBytes(T value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Little-endian, as every machine this runs on.
std::string PlyBytes(const Scene& scene, const LabelledMesh& mesh) {
  std::string bytes = Format(
      "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nproperty ushort label\nelement face %zu\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.points_W.size(), mesh.triangles.size());
  for (size_t i = 0; i < mesh.points_W.size(); ++i) {
    for (const double x : mesh.points_W[i]) AppendBytes(static_cast<float>(x), &bytes);
    AppendBytes(FindObject(scene, mesh.object_ids[i])->color, &bytes);
    AppendBytes(mesh.object_ids[i], &bytes);
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    AppendBytes(uint8_t{3}, &bytes);
    for (const int index : triangle) AppendBytes(int32_t{index}, &bytes);
  }
  return bytes;
}

/// Whether a camera saw this point of the surface: it is the nearest thing in its pixel.
bool Sees(const PinholeCamera& camera, const Pose& T_C_W, const Image<float>& depth,
          const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d p_C = T_C_W * p_W;
  if (p_C.z() < 0.1) return false;
  const Eigen::Vector2d pixel = camera.Project(p_C);
  const int u = static_cast<int>(std::floor(pixel.x() + 0.5));
  const int v = static_cast<int>(std::floor(pixel.y() + 0.5));
  return depth.Contains(v, u) && std::abs(p_C.z() - double{depth(v, u)}) < 0.02 * p_C.z();
}

struct Views {
  PinholeCamera camera;
  std::vector<Pose> T_C_W;
  std::vector<Image<float>> depths;
  std::map<uint16_t, int> frames_of_object;
};

void AddView(const FrameHeader& header, Rendering&& image, Views* views) {
  std::map<uint16_t, int> pixels;
  for (const uint16_t id : image.object_ids.pixels()) ++pixels[id];
  for (const auto& [id, count] : pixels) views->frames_of_object[id] += count >= kSeenPixels;
  views->camera = header.camera;
  views->T_C_W.push_back(header.T_W_C.inverse());
  views->depths.push_back(std::move(image.depth));
}

/// Images, trajectory, times and detections; returns what the cameras saw.
Views WriteFrames(const SyntheticOptions& options, const Scene& scene, const std::string& id,
                  Writer* writer) {
  const auto dataset = MakeSyntheticDataset(options, {});
  const auto detections = MakeSyntheticDetections(options);
  Views views;
  std::string trajectory, times;
  nlohmann::json results = nlohmann::json::array();
  for (size_t i = 0; i < dataset->size() && writer->status(); ++i) {
    const FrameHeader header = dataset->Header(i);
    const int number = static_cast<int>(header.frame_number);
    Rendering image = Render(scene, header.camera, header.T_W_C);
    writer->WriteBytes(id + Format("/image/image%05d.png", number), PngColor(image.color));
    writer->WriteBytes(id + Format("/depth/depth%05d.png", number), Png16(dataset->Read(i)->depth));
    writer->WriteBytes(id + Format("/mask/mask_image%05d.png", number), Png16(image.object_ids));
    trajectory += PoseText(number - 1, header.T_W_C);
    times += Format("%d %lld\n", number, static_cast<long long>(header.utime));
    AppendDetections(*detections->ForFrame(header), &results);
    AddView(header, std::move(image), &views);
  }
  writer->WriteText(id + "/trajectory.log", trajectory);
  writer->WriteText(id + "/timestamp.txt", times);
  writer->WriteText(id + "/detections.json", results.dump());
  return views;
}

}  // namespace

Result<void> ExportSceneNn(const SyntheticOptions& options, const fs::path& root,
                           const std::string& id) {
  const Scene scene = MakeScene(options);
  Writer writer(root);
  const Views views = WriteFrames(options, scene, id, &writer);
  if (!writer.status()) return writer.status();
  const auto seen = [&](const Eigen::Vector3d& p_W, const Eigen::Vector3d&) {
    for (size_t i = 0; i < views.depths.size(); ++i) {
      if (Sees(views.camera, views.T_C_W[i], views.depths[i], p_W)) return true;
    }
    return false;
  };
  const LabelledMesh mesh = Tessellate(scene, kMeshSpacing, seen);
  writer.WriteText("intrinsic/asus.ini", IniText(views.camera, options.rate));
  writer.WriteText(id + "/" + id + ".xml", XmlText(scene, views.frames_of_object, mesh));
  writer.WriteText(id + "/" + id + ".ply", PlyBytes(scene, mesh));
  return writer.status();
}

}  // namespace vismap
