#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace vismap {

/// Writes ONNX models without the library: just enough of protobuf's encoding and of
/// onnx.proto (opset 11) for small graphs of convolutions. Field numbers are those of onnx.proto.
class OnnxGraph {
 public:
  using Names = std::vector<std::string>;
  using Shape = std::vector<int64_t>;

  void AddInput(const std::string& name, const Shape& shape) { Text(11, ValueInfo(name, shape)); }
  void AddOutput(const std::string& name, const Shape& shape) { Text(12, ValueInfo(name, shape)); }

  void AddConstant(const std::string& name, const Shape& shape, const std::vector<float>& values) {
    AddTensor(name, shape, 1, Bytes(values));
  }
  void AddConstant(const std::string& name, const std::vector<int64_t>& values) {
    AddTensor(name, {static_cast<int64_t>(values.size())}, 7, Bytes(values));
  }

  /// An operator; `attributes` as made by Integer and Integers.
  void AddNode(const std::string& type, const Names& inputs, const std::string& output,
               const Names& attributes = {}) {
    std::string node;
    for (const std::string& input : inputs) node += Field(1, input);
    node += Field(2, output) + Field(3, "node_" + output) + Field(4, type);
    for (const std::string& attribute : attributes) node += Field(5, attribute);
    Text(1, node);
  }
  static std::string Integer(const std::string& name, int64_t value) {
    return Field(1, name) + Number(3, value) + Number(20, 2);
  }
  static std::string Integers(const std::string& name, const std::vector<int64_t>& values) {
    std::string attribute = Field(1, name);
    for (const int64_t value : values) attribute += Number(8, value);
    return attribute + Number(20, 7);
  }

  /// The bytes of the whole model.
  std::string Model() const {
    const std::string opset = Field(1, "") + Number(2, 11);
    return Number(1, 6) + Field(7, Field(2, "tiny") + graph_) + Field(8, opset);
  }

 private:
  static std::string Varint(uint64_t value) {
    std::string bytes;
    for (; value >= 128; value >>= 7) bytes += static_cast<char>(value % 128 + 128);
    return bytes + static_cast<char>(value);
  }
  static std::string Number(uint64_t field, int64_t value) {
    return Varint(field << 3) + Varint(static_cast<uint64_t>(value));
  }
  static std::string Field(uint64_t field, const std::string& bytes) {
    return Varint((field << 3) | 2) + Varint(bytes.size()) + bytes;
  }
  template <typename T>
  static std::string Bytes(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }
  static std::string ValueInfo(const std::string& name, const Shape& shape) {
    std::string dimensions;
    for (const int64_t side : shape) dimensions += Field(1, Number(1, side));
    return Field(1, name) + Field(2, Field(1, Number(1, 1) + Field(2, dimensions)));
  }
  void AddTensor(const std::string& name, const Shape& shape, int type, const std::string& raw) {
    std::string tensor;
    for (const int64_t side : shape) tensor += Number(1, side);
    Text(5, tensor + Number(2, type) + Field(8, name) + Field(9, raw));
  }
  void Text(uint64_t field, const std::string& bytes) { graph_ += Field(field, bytes); }

  std::string graph_;
};

/// A network of YOLO-seg's shapes that finds red things: input 1x3x64x64, 64 cells of 8 x 8 pixels,
/// two classes, two mask coefficients. Every cell that is mostly red says "an object of class 0,
/// its box is the whole input"; the mask is where cells are red, so NMS leaves one detection.
struct TinyYolo {
  static constexpr int kSide = 64, kCells = 8, kClasses = 2, kCoefficients = 2;
  bool objectness = false;     ///< v5: with objectness 0.9
  bool features_last = false;  ///< 1 x rows x features
  bool prototypes = true;      ///< false: a network without masks

  std::string Model() const {
    OnnxGraph graph;
    graph.AddInput("images", {1, 3, kSide, kSide});
    // Sharp logit of redness: above 0 for the couch of the built-in room, far below for all greys.
    const Channel red{200, -100, -100, -50}, never{0, 0, 0, -30}, likely{0, 0, 0, 2.1972246f};
    AddConvolution(&graph, "box", {{0, 0, 0, 32}, {0, 0, 0, 32}, {0, 0, 0, 64}, {0, 0, 0, 64}});
    AddConvolution(&graph, "logits",
                   objectness ? Channels{likely, red, never} : Channels{red, never});
    graph.AddNode("Sigmoid", {"logits"}, "scores");
    AddConvolution(&graph, "coefficients", {{0, 0, 0, 1}, {0, 0, 0, 0}});
    const int64_t features = 4 + kClasses + kCoefficients + (objectness ? 1 : 0);
    graph.AddNode("Concat", {"box", "scores", "coefficients"}, "grid",
                  {OnnxGraph::Integer("axis", 1)});
    graph.AddConstant("head_shape", {1, features, kCells * kCells});
    graph.AddNode("Reshape", {"grid", "head_shape"}, features_last ? "rows" : "output0");
    if (features_last)
      graph.AddNode("Transpose", {"rows"}, "output0", {OnnxGraph::Integers("perm", {0, 2, 1})});
    constexpr int64_t kRows = kCells * kCells;
    if (features_last) {
      graph.AddOutput("output0", {1, kRows, features});
    } else {
      graph.AddOutput("output0", {1, features, kRows});
    }
    if (prototypes) {
      AddConvolution(&graph, "output1", {red, never});
      graph.AddOutput("output1", {1, kCoefficients, kCells, kCells});
    }
    return graph.Model();
  }

  /// The text of a file of class names for it: class 0 is a chair, class 1 a cup.
  static std::string ClassNames() { return "chair\ncup\n"; }

 private:
  /// Weights of the mean red, green, blue of a cell, and the constant.
  struct Channel {
    float r, g, b, constant;
  };
  using Channels = std::vector<Channel>;

  static void AddConvolution(OnnxGraph* graph, const std::string& name, const Channels& channels) {
    constexpr int kStride = kSide / kCells;
    std::vector<float> weights, constants;
    for (const Channel& channel : channels) {
      for (const float weight : {channel.r, channel.g, channel.b})
        weights.insert(weights.end(), kStride * kStride, weight / (kStride * kStride));
      constants.push_back(channel.constant);
    }
    const auto count = static_cast<int64_t>(channels.size());
    graph->AddConstant(name + "_w", {count, 3, kStride, kStride}, weights);
    graph->AddConstant(name + "_b", {count}, constants);
    graph->AddNode("Conv", {"images", name + "_w", name + "_b"}, name,
                   {OnnxGraph::Integers("kernel_shape", {kStride, kStride}),
                    OnnxGraph::Integers("strides", {kStride, kStride})});
  }
};

}  // namespace vismap
