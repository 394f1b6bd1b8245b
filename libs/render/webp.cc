#include "render/webp.h"

#include <opencv2/imgcodecs.hpp>
#include <string_view>

// A WebP file is a list of chunks: four letters, u32 size, content, and a zero when the size is
// odd. The file itself is the chunk RIFF, whose content begins with the letters WEBP. OpenCV writes
// files of one picture; those of an animation stand each in a chunk ANMF. All numbers are
// little-endian.

namespace vismap {
namespace {

constexpr size_t kFileHead = 12;  // "RIFF", size, "WEBP"

void Put(uint64_t value, int bytes, std::vector<uint8_t>* out) {
  for (int i = 0; i < bytes; ++i) out->push_back(static_cast<uint8_t>(value >> (8 * i)));
}

void Put(std::string_view letters, std::vector<uint8_t>* out) {
  out->insert(out->end(), letters.begin(), letters.end());
}

void PutChunk(std::string_view name, std::span<const uint8_t> content, std::vector<uint8_t>* out) {
  Put(name, out);
  Put(content.size(), 4, out);
  out->insert(out->end(), content.begin(), content.end());
  if (content.size() % 2 == 1) out->push_back(0);
}

}  // namespace

std::vector<uint8_t> EncodeWebp(const Image<Rgb8>& image, int quality) {
  Require(!image.empty() && image.width() <= kMaxWebpSide && image.height() <= kMaxWebpSide,
          "a WebP has 1 to 16383 pixels along each side");
  cv::Mat bgr(image.height(), image.width(), CV_8UC3);
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      const Rgb8& c = image(v, u);
      bgr.at<cv::Vec3b>(v, u) = {c.b, c.g, c.r};
    }
  }
  std::vector<uint8_t> bytes;
  Require(cv::imencode(".webp", bgr, bytes, {cv::IMWRITE_WEBP_QUALITY, quality}),
          "OpenCV can write WebP");
  return bytes;
}

WebpAnimation::WebpAnimation(int width, int height, int frame_ms, int quality)
    : width_(width), height_(height), frame_ms_(frame_ms), quality_(quality) {
  Require(frame_ms > 0 && frame_ms < 1 << 24, "a picture is shown for 1 to 2^24 - 1 ms");
}

void WebpAnimation::Add(const Image<Rgb8>& image) {
  Require(image.width() == width_ && image.height() == height_,
          "all pictures of an animation have the same size");
  constexpr uint8_t kReplaces = 2;  // the picture is not blended with the one before
  std::vector<uint8_t> frame;
  Put(0, 6, &frame);  // its corner is that of the animation
  Put(static_cast<uint64_t>(width_ - 1), 3, &frame);
  Put(static_cast<uint64_t>(height_ - 1), 3, &frame);
  Put(static_cast<uint64_t>(frame_ms_), 3, &frame);
  frame.push_back(kReplaces);
  const std::vector<uint8_t> file = EncodeWebp(image, quality_);
  frame.insert(frame.end(), file.begin() + kFileHead, file.end());
  PutChunk("ANMF", frame, &frames_);
}

std::vector<uint8_t> WebpAnimation::Finish() const {
  Require(!frames_.empty(), "an animation has at least one picture");
  constexpr uint64_t kAnimated = 2;
  std::vector<uint8_t> head, animation, content;
  Put(kAnimated, 4, &head);
  Put(static_cast<uint64_t>(width_ - 1), 3, &head);
  Put(static_cast<uint64_t>(height_ - 1), 3, &head);
  Put(0xFFFFFFFF, 4, &animation);  // background: white
  Put(0, 2, &animation);           // repeats for ever
  Put("WEBP", &content);
  PutChunk("VP8X", head, &content);
  PutChunk("ANIM", animation, &content);
  content.insert(content.end(), frames_.begin(), frames_.end());
  std::vector<uint8_t> file;
  PutChunk("RIFF", content, &file);
  return file;
}

}  // namespace vismap
