#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vismap {

/// The shape {batch, 3, height, width} of the first input of an ONNX model (the bytes of its file)
/// that can be a colour image; sides that the model leaves open are 0. Empty when there is none,
/// also when the bytes are no model. OpenCV 4.6 keeps this to itself.
std::vector<int> OnnxImageShape(std::span<const uint8_t> model);

}  // namespace vismap
