#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// The shape {batch, 3, height, width} of the first input of an ONNX model that can be a colour
/// image. `model` has the bytes of its file. Sides that the model leaves open are 0. Empty if there
/// is no such input, or if the bytes are not a model. OpenCV 4.6 has no function for this.
std::vector<int> OnnxImageShape(std::span<const uint8_t> model);

}  // namespace vismap
