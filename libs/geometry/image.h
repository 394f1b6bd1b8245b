#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/buffer_pool.h"
#include "base/require.h"

namespace vismap {

/// A colour, 8 bits per channel.
struct Rgb8 {
  uint8_t r = 0;
  uint8_t g = 0;
  uint8_t b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Dense row-major image that owns its pixels, indexed (row v, column u). Pixel centres lie at
/// integer (u, v).
template <typename T>
class Image {
 public:
  using Pixels = std::vector<T, PooledAllocator<T>>;

  Image() = default;
  Image(int width, int height, const T& fill = T{}) : width_(width), height_(height) {
    Require(width >= 0 && height >= 0, "image sizes are not negative");
    pixels_.assign(static_cast<size_t>(width) * static_cast<size_t>(height), fill);
  }

  /// An image whose pixels are not initialised, for kernels that set them all.
  static Image Unset(int width, int height) {
    Require(width >= 0 && height >= 0, "image sizes are not negative");
    Image image;
    image.width_ = width;
    image.height_ = height;
    image.pixels_.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    return image;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  size_t size() const { return pixels_.size(); }
  bool empty() const { return pixels_.empty(); }
  bool Contains(int v, int u) const { return v >= 0 && u >= 0 && v < height_ && u < width_; }

  T& operator()(int v, int u) { return pixels_[Offset(v, u)]; }
  const T& operator()(int v, int u) const { return pixels_[Offset(v, u)]; }
  T* row(int v) { return pixels_.data() + Offset(v, 0); }
  const T* row(int v) const { return pixels_.data() + Offset(v, 0); }
  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }
  Pixels& pixels() { return pixels_; }
  const Pixels& pixels() const { return pixels_; }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  size_t Offset(int v, int u) const {
    return static_cast<size_t>(v) * static_cast<size_t>(width_) + static_cast<size_t>(u);
  }

  int width_ = 0;
  int height_ = 0;
  Pixels pixels_;
};

}  // namespace vismap
