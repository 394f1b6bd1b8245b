#include "rectify/rectify_color.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/require.h"
#include "rectify/lens.h"

namespace vismap {
namespace {

constexpr uint32_t kOne = 256;  // of the fixed-point numbers

// Every pixel of the result is the mean of four; of an odd size, the last row or column is dropped.
Image<Rgb8> Halve(const Image<Rgb8>& image) {
  Image<Rgb8> half = Image<Rgb8>::Unset(image.width() / 2, image.height() / 2);
  ParallelFor(static_cast<size_t>(half.height()), 16, [&](size_t row) {
    const int v = static_cast<int>(row);
    const Rgb8* above = image.row(2 * v);
    const Rgb8* below = image.row(2 * v + 1);
    Rgb8* out = half.row(v);
    const auto mean = [](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
      return static_cast<uint8_t>((a + b + c + d + 2) / 4);
    };
    for (int u = 0; u < half.width(); ++u, above += 2, below += 2) {
      out[u] = {mean(above[0].r, above[1].r, below[0].r, below[1].r),
                mean(above[0].g, above[1].g, below[0].g, below[1].g),
                mean(above[0].b, above[1].b, below[0].b, below[1].b)};
    }
  });
  return half;
}

int32_t Fixed(double value, int size) {
  return static_cast<int32_t>(
      std::lround(std::clamp(value, 0.0, static_cast<double>(size - 1)) * kOne));
}

Rgb8 Sample(const Image<Rgb8>& image, ColorSource at) {
  const uint32_t x = static_cast<uint32_t>(at.x), y = static_cast<uint32_t>(at.y);
  const uint32_t fx = x % kOne, fy = y % kOne;
  const size_t u = x / kOne, next = std::min(u + 1, static_cast<size_t>(image.width()) - 1);
  const int v = static_cast<int>(y / kOne);
  const Rgb8* above = image.row(v);
  const Rgb8* below = image.row(std::min(v + 1, image.height() - 1));
  const uint32_t w00 = (kOne - fx) * (kOne - fy), w01 = fx * (kOne - fy);
  const uint32_t w10 = (kOne - fx) * fy, w11 = fx * fy;
  const auto mix = [&](uint8_t Rgb8::*channel) {
    return static_cast<uint8_t>((w00 * above[u].*channel + w01 * above[next].*channel +
                                 w10 * below[u].*channel + w11 * below[next].*channel +
                                 kOne * kOne / 2) /
                                (kOne * kOne));
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

}  // namespace

ColorTable MakeColorTable(const LensCamera& from, const PinholeCamera& target) {
  ColorTable table{from.pinhole.width, from.pinhole.height, 0,
                   Image<ColorSource>(target.width, target.height)};
  double scale = target.fx / from.pinhole.fx;
  while (scale < 0.6 && (std::min(table.width, table.height) >> (table.halvings + 1)) > 0) {
    scale *= 2;
    ++table.halvings;
  }
  const int width = table.width >> table.halvings, height = table.height >> table.halvings;
  const double shrink = 1.0 / (1 << table.halvings);
  const double limit = MaxRayRadius(from);
  ParallelFor(static_cast<size_t>(target.height), 8, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < target.width; ++u) {
      Eigen::Vector2d ray((u - target.cx) / target.fx, (v - target.cy) / target.fy);
      if (const double length = ray.norm(); length > limit) ray *= limit / length;
      const Eigen::Vector2d pixel = Distort(from, ray);
      table.sources(v, u) = {Fixed((pixel.x() + 0.5) * shrink - 0.5, width),
                             Fixed((pixel.y() + 0.5) * shrink - 0.5, height)};
    }
  });
  return table;
}

Image<Rgb8> RectifyColor(const Image<Rgb8>& color, const ColorTable& table) {
  Require(color.width() == table.width && color.height() == table.height,
          "colour has the size of its table");
  Image<Rgb8> halved;
  for (int i = 0; i < table.halvings; ++i) halved = Halve(i == 0 ? color : halved);
  const Image<Rgb8>& source = table.halvings == 0 ? color : halved;
  Image<Rgb8> result = Image<Rgb8>::Unset(table.sources.width(), table.sources.height());
  ParallelFor(static_cast<size_t>(result.height()), 16, [&](size_t row) {
    const int v = static_cast<int>(row);
    const ColorSource* from = table.sources.row(v);
    Rgb8* to = result.row(v);
    for (int u = 0; u < result.width(); ++u) to[u] = Sample(source, from[u]);
  });
  return result;
}

}  // namespace vismap
