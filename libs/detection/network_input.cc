#include "detection/network_input.h"

#include <opencv2/imgproc.hpp>

namespace vismap {
namespace {

constexpr float kPadding = 114;  // the grey of Ultralytics

/// A tensor 1x3xHxW with the resized image at the top left and padding elsewhere, times `factor`.
Tensor Planes(const Image<Rgb8>& color, const Letterbox& letterbox, int width, int height,
              float factor) {
  const cv::Mat pixels(color.height(), color.width(), CV_8UC3, const_cast<Rgb8*>(color.data()));
  cv::Mat resized;
  cv::resize(pixels, resized, cv::Size(letterbox.width, letterbox.height), 0, 0, cv::INTER_LINEAR);
  const size_t plane = static_cast<size_t>(width) * static_cast<size_t>(height);
  Tensor tensor{{1, 3, height, width}, std::vector<float>(3 * plane, kPadding * factor)};
  for (int v = 0; v < resized.rows; ++v) {
    const uint8_t* row = resized.ptr<uint8_t>(v);
    float* to = &tensor.values[static_cast<size_t>(v) * static_cast<size_t>(width)];
    for (size_t i = 0; i < static_cast<size_t>(resized.cols); ++i) {
      for (size_t channel = 0; channel < 3; ++channel)
        to[channel * plane + i] = static_cast<float>(row[3 * i + channel]) * factor;
    }
  }
  return tensor;
}

}  // namespace

Tensor YoloInput(const Image<Rgb8>& color, const Letterbox& letterbox) {
  return Planes(color, letterbox, letterbox.input_width, letterbox.input_height, 1.0f / 255);
}

Tensor MaskRcnnInput(const Image<Rgb8>& color, const Letterbox& letterbox) {
  return Planes(color, letterbox, letterbox.width, letterbox.height, 1);
}

}  // namespace vismap
