#include "detection/dnn_detector.h"

#include <filesystem>
#include <utility>

#include "base/file.h"
#include "base/require.h"
#include "detection/network_input.h"
#include "detection/onnx_input.h"
#include "detection/read_outputs.h"

namespace vismap {
namespace {

const std::vector<std::string> kMaskRcnnOutputs = {"detection_out_final", "detection_masks"};

/// The kind of the network; kAuto is resolved by the file name.
Result<DnnModelKind> KindOf(const DnnDetectorOptions& options) {
  if (options.kind != DnnModelKind::kAuto) return options.kind;
  const std::string ending = std::filesystem::path(options.model).extension();
  if (ending == ".onnx") return DnnModelKind::kYoloSeg;
  if (ending == ".pb") return DnnModelKind::kMaskRcnn;
  return Fail(
      options.model +
      ": the kind of this network is unknown; expected .onnx (YOLO) or .pb (Mask R-CNN), or "
      "the key `kind` in the config");
}

Result<ClassTable> ClassesOf(const DnnDetectorOptions& options) {
  if (!options.class_names.empty()) return LoadClassTable(options.class_names);
  return options.kind == DnnModelKind::kMaskRcnn ? Coco90() : Coco80();
}

/// The size of the input that the options or the model state; zeros = that of the image.
Result<InputSize> InputSizeOf(const DnnDetectorOptions& options) {
  if (options.input_size_px > 0) return InputSize{options.input_size_px, options.input_size_px};
  if (!options.graph.empty()) return InputSize{};
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(options.model, UINT32_MAX);  // checked
  if (!bytes) return tl::unexpected(bytes.error());
  const std::vector<int> shape = OnnxImageShape(*bytes);
  return shape.empty() ? InputSize{} : InputSize{shape[3], shape[2]};
}

}  // namespace

DnnDetector::DnnDetector(const DnnDetectorOptions& options, Network network, ClassTable classes,
                         InputSize input)
    : options_(options),
      network_(std::move(network)),
      classes_(std::move(classes)),
      input_(input) {}

Result<std::unique_ptr<DnnDetector>> DnnDetector::Load(const DnnDetectorOptions& options) {
  DnnDetectorOptions decided = options;
  const Result<DnnModelKind> kind = KindOf(options);
  if (!kind) return tl::unexpected(kind.error());
  decided.kind = *kind;
  Result<ClassTable> classes = ClassesOf(decided);
  if (!classes) return tl::unexpected(classes.error());
  Result<Network> network = Network::Load(options.model, options.graph, options.threads);
  if (!network) return tl::unexpected(network.error());
  const auto input = InputSizeOf(options);
  if (!input) return tl::unexpected(input.error());
  std::unique_ptr<DnnDetector> detector(
      new DnnDetector(decided, std::move(*network), std::move(*classes), *input));
  const auto tried = detector->FindInstances(Image<Rgb8>(640, 480));
  if (!tried) return Fail(options.model + ": " + tried.error().message);
  return detector;
}

Letterbox DnnDetector::FitInput(const Image<Rgb8>& color) const {
  const int width = input_.width > 0 ? input_.width : color.width();
  const int height = input_.height > 0 ? input_.height : color.height();
  return FitLetterbox(color.width(), color.height(), width, height);
}

Result<std::vector<Detection>> DnnDetector::FindInstances(const Image<Rgb8>& color) {
  if (options_.kind == DnnModelKind::kMaskRcnn) {
    const auto outputs = network_.Run(MaskRcnnInput(color, FitInput(color)), kMaskRcnnOutputs);
    if (!outputs) return tl::unexpected(outputs.error());
    return MaskRcnnDetections((*outputs)[0], (*outputs)[1], color.width(), color.height(), classes_,
                              options_);
  }
  const Letterbox letterbox = FitInput(color);
  auto outputs = network_.Run(YoloInput(color, letterbox), {});
  if (!outputs) return tl::unexpected(outputs.error());
  return YoloDetections(std::move(*outputs), letterbox, classes_, options_);
}

Result<DetectionSet> DnnDetector::Detect(const Image<Rgb8>& color, const FrameHeader& header) {
  Require(!color.empty(), "a detector looks at a colour image");
  auto detections = FindInstances(color);
  if (!detections) return Fail(options_.model + ": " + detections.error().message);
  return DetectionSet{header.utime, header.camera_id, header.frame_number, std::move(*detections)};
}

}  // namespace vismap
