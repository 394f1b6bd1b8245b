#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "detection/tensor.h"

namespace vismap {

/// A trained network, run on the processor by OpenCV. For one thread at a time. What OpenCV throws
/// comes back as an error in one line.
class Network {
 public:
  /// Reads ONNX, or with `graph` (or a .pb file) TensorFlow. `threads` of all networks of the
  /// process; 0 = all processors. Fails naming the file when it is missing or cannot be read.
  static Result<Network> Load(const std::string& model, const std::string& graph, int threads);
  ~Network();
  Network(Network&&) noexcept;
  Network& operator=(Network&&) noexcept;

  /// The outputs with these names; of no names, all outputs. `input` is batch x channels x height x
  /// width. Fails with what OpenCV says.
  Result<std::vector<Tensor>> Run(const Tensor& input, const std::vector<std::string>& outputs);

 private:
  struct Net;
  explicit Network(std::unique_ptr<Net> net);
  std::unique_ptr<Net> net_;
};

}  // namespace vismap
