#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace vismap {

/// Dense numbers that go into or come out of a network, last dimension fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<float> values;  ///< as many as the product of `shape`
};

/// "1x116x2100", for errors.
inline std::string ShapeText(const std::vector<int>& shape) {
  std::string text;
  for (const int side : shape) text += (text.empty() ? "" : "x") + std::to_string(side);
  return text.empty() ? "nothing" : text;
}

/// "1x116x2100 and 1x32x80x80".
inline std::string ShapesText(const std::vector<Tensor>& tensors) {
  std::string text;
  for (const Tensor& tensor : tensors)
    text += (text.empty() ? "" : " and ") + ShapeText(tensor.shape);
  return text.empty() ? "nothing" : text;
}

}  // namespace vismap
