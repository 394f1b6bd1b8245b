#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "detection/tensor.h"

namespace vismap {

/// A trained network, which OpenCV runs on the CPU. Only one thread may use it at a time.
/// Exceptions of OpenCV are returned as errors in one line.
class Network {
 public:
  /// Loads an ONNX file, or, if `graph` is given or `model` ends in .pb, a network of TensorFlow.
  /// `threads` sets the number of threads of all networks in the process; 0 = all processors.
  /// Fails, naming the file, if it is missing, larger than 2 GB or cannot be read.
  static Result<Network> Load(const std::string& model, const std::string& graph, int threads);
  ~Network();
  Network(Network&&) noexcept;
  Network& operator=(Network&&) noexcept;

  /// Runs the network and returns the outputs with these names, or all outputs if there are no
  /// names. `input` is batch x channels x height x width. Fails with the message of OpenCV.
  Result<std::vector<Tensor>> Run(const Tensor& input, const std::vector<std::string>& outputs);

 private:
  struct Net;
  explicit Network(std::unique_ptr<Net> net);
  std::unique_ptr<Net> net_;
};

}  // namespace vismap
