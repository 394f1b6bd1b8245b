#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace vismap {

/// A dense array: the input or an output of a network. The last dimension varies fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<float> values;  ///< as many as the product of `shape`
};

/// The shape as text for errors, such as "1x116x2100".
inline std::string ShapeText(const std::vector<int>& shape) {
  std::string text;
  for (const int side : shape) text += (text.empty() ? "" : "x") + std::to_string(side);
  return text.empty() ? "nothing" : text;
}

/// The shapes as text for errors, such as "1x116x2100 and 1x32x80x80".
inline std::string ShapesText(const std::vector<Tensor>& tensors) {
  std::string text;
  for (const Tensor& tensor : tensors)
    text += (text.empty() ? "" : " and ") + ShapeText(tensor.shape);
  return text.empty() ? "nothing" : text;
}

}  // namespace vismap
