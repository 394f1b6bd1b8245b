#include "render/png.h"

#include <opencv2/imgcodecs.hpp>

#include "base/file.h"

namespace vismap {

std::vector<uint8_t> EncodePng(const Image<Rgb8>& image) {
  Require(!image.empty(), "a PNG has at least one pixel");
  cv::Mat bgr(image.height(), image.width(), CV_8UC3);
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      const Rgb8& c = image(v, u);
      bgr.at<cv::Vec3b>(v, u) = {c.b, c.g, c.r};
    }
  }
  std::vector<uint8_t> bytes;
  Require(cv::imencode(".png", bgr, bytes), "OpenCV can write PNG");
  return bytes;
}

Result<void> WritePng(const std::filesystem::path& path, const Image<Rgb8>& image) {
  return WriteFileAtomically(path, EncodePng(image));
}

}  // namespace vismap
