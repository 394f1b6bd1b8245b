#include "sample_images.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "codecs/color_codec.h"

namespace vismap {
namespace {

std::vector<uint8_t> Png(const cv::Mat& image) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  return bytes;
}

}  // namespace

std::vector<uint8_t> GreyPng(int width, int height, int value, int bits) {
  return Png(cv::Mat(height, width, bits == 16 ? CV_16UC1 : CV_8UC1, cv::Scalar(value)));
}

std::vector<uint8_t> ColorPng(int width, int height, int bits) {
  const double full = bits == 16 ? 65535 : 255;
  cv::Mat image(height, width, bits == 16 ? CV_16UC3 : CV_8UC3, cv::Scalar(0, full, 0));
  image.colRange(0, width / 2).setTo(cv::Scalar(0, 0, full));
  return Png(image);
}

std::vector<uint8_t> ColorJpeg(int width, int height) {
  Image<Rgb8> image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      image(v, u) = u < width / 2 ? Rgb8{255, 0, 0} : Rgb8{0, 255, 0};
    }
  }
  return EncodeJpeg(image);
}

}  // namespace vismap
