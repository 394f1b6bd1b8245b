#pragma once

#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "datasets/scenenn_writer.h"
#include "simulation/seen_surface.h"
#include "simulation/synthetic_dataset.h"

namespace vismap::testing_support {

inline constexpr double kMeshSpacing = 0.03;  // edge length of the triangles [m]

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

inline std::vector<uint8_t> PngColor(const Image<Rgb8>& image) {
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

/// The name that SceneNN's annotations use for an object.
inline std::string KindOf(const std::string& name) {
  static const std::map<std::string, std::string> kKinds{
      {"couch", "sofa"},         {"dining table", "table"}, {"book", "books"},
      {"potted plant", "plant"}, {"backpack", "bag"},       {"box", "boxes"},
      {"small box", "boxes"}};
  const auto found = kKinds.find(name);
  return found == kKinds.end() ? name : found->second;
}

inline std::string XmlText(const Scene& scene, std::map<uint16_t, int> frames,
                           const LabelledMesh& mesh) {
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

/// The mesh as binary little-endian PLY. Numbers are copied, so the machine must be little-endian,
/// too.
inline std::string PlyBytes(const Scene& scene, const LabelledMesh& mesh) {
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

/// Writes images, trajectory, times and detections. Returns the surface that the cameras saw.
inline SeenSurface WriteFrames(const SyntheticOptions& options, const Scene& scene,
                               SceneNnWriter* writer) {
  const auto dataset = MakeSyntheticDataset(options, {});
  const auto detections = MakeSyntheticDetections(options);
  const std::vector<FrameHeader> headers = MakeHeaders(options);
  SeenSurface seen;
  for (size_t i = 0; i < dataset->size() && writer->status(); ++i) {
    const FrameHeader& header = headers[i];
    const int number = static_cast<int>(header.frame_number);
    Rendering image = Render(scene, header.camera, header.T_W_C);
    writer->AddFrame(dataset->Header(i), dataset->Read(i)->depth, {".png", PngColor(image.color)});
    writer->Write(Format("mask/mask_image%05d.png", number), EncodePng16(image.object_ids));
    writer->AddDetections(*detections->ForFrame(header));
    seen.AddView(header, std::move(image));
  }
  return seen;
}

/// Writes a computed sequence and its ground truth as files in SceneNN's layout. Writes
/// root/intrinsic/asus.ini and, in root/ID: image/, depth/ (16-bit, mm), mask/ (16-bit, object
/// ids), timestamp.txt, trajectory.log, detections.json (COCO results), ID.ply (the surface that
/// some frame saw, in triangles of 3 cm with a label per vertex) and ID.xml (a description of each
/// label). Frames and detections read back are equal bit for bit, with one exception: frames on
/// which the detector did not run have an empty set of detections, because COCO results cannot
/// express the difference. Fails with the name of the file that cannot be written.
inline Result<void> ExportSceneNn(const SyntheticOptions& options,
                                  const std::filesystem::path& root, const std::string& id) {
  const Scene scene = MakeScene(options);
  SceneNnWriter writer(root / id);
  const SeenSurface seen = WriteFrames(options, scene, &writer);
  if (!writer.status()) return writer.status();
  const LabelledMesh mesh = seen.Triangles(scene, kMeshSpacing);
  writer.Write("../intrinsic/asus.ini",
               SceneNnIni(MakeHeaders(options).front().camera, options.rate));
  writer.Write(id + ".xml", XmlText(scene, seen.frames_of_object(), mesh));
  writer.Write(id + ".ply", PlyBytes(scene, mesh));
  return writer.Finish();
}

}  // namespace vismap::testing_support
