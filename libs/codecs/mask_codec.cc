#include "codecs/mask_codec.h"

#include <algorithm>
#include <climits>

#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

/// Rows [v0, v1) and columns [u0, u1).
struct PixelBox {
  int u0 = INT_MAX, v0 = INT_MAX, u1 = 0, v1 = 0;

  void Include(int v_begin, int v_end, int u) {
    u0 = std::min(u0, u);
    u1 = std::max(u1, u + 1);
    v0 = std::min(v0, v_begin);
    v1 = std::max(v1, v_end);
  }
  bool empty() const { return u1 == 0; }
};

Mask EmptyMask(int width, int height, const PixelBox& box) {
  Mask mask{.image_width = width, .image_height = height, .u0 = 0, .v0 = 0, .inside = {}};
  if (box.empty()) return mask;
  mask.u0 = box.u0;
  mask.v0 = box.v0;
  mask.inside = Image<uint8_t>(box.u1 - box.u0, box.v1 - box.v0);
  return mask;
}

/// Calls visit(u, v_begin, v_end) for the pixels inside, part by part of a column.
template <typename Visit>
void VisitInside(std::span<const uint32_t> runs, int height, const Visit& visit) {
  const uint64_t rows = static_cast<uint64_t>(height);
  uint64_t begin = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    const uint64_t end = begin + runs[i];
    if (i % 2 == 1) {
      for (uint64_t at = begin; at < end;) {
        const uint64_t u = at / rows;
        const uint64_t stop = std::min(end, (u + 1) * rows);
        visit(static_cast<int>(u), static_cast<int>(at - u * rows),
              static_cast<int>(stop - u * rows));
        at = stop;
      }
    }
    begin = end;
  }
}

}  // namespace

Mask MaskFromImage(const Image<uint8_t>& image) {
  PixelBox box;
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      if (image(v, u) != 0) box.Include(v, v + 1, u);
    }
  }
  Mask mask = EmptyMask(image.width(), image.height(), box);
  for (int v = 0; v < mask.inside.height(); ++v) {
    for (int u = 0; u < mask.inside.width(); ++u) {
      mask.inside(v, u) = image(v + mask.v0, u + mask.u0) != 0;
    }
  }
  return mask;
}

MaskRuns EncodeMask(const Mask& mask) {
  Require(mask.u0 >= 0 && mask.v0 >= 0 && mask.u0 + mask.inside.width() <= mask.image_width &&
              mask.v0 + mask.inside.height() <= mask.image_height,
          "the box of a mask lies in its image");
  const auto height = static_cast<uint32_t>(mask.image_height);
  MaskRuns runs{0};
  const auto add = [&](uint32_t count, bool inside) {
    if (count == 0) return;
    if (inside != (runs.size() % 2 == 0)) runs.push_back(0);
    runs.back() += count;
  };
  add(static_cast<uint32_t>(mask.u0) * height, false);
  for (int u = 0; u < mask.inside.width(); ++u) {
    add(static_cast<uint32_t>(mask.v0), false);
    for (int v = 0; v < mask.inside.height(); ++v) add(1, mask.inside(v, u) != 0);
    add(height - static_cast<uint32_t>(mask.v0 + mask.inside.height()), false);
  }
  add(static_cast<uint32_t>(mask.image_width - mask.u0 - mask.inside.width()) * height, false);
  return runs;
}

Result<Mask> DecodeMask(std::span<const uint32_t> runs, int width, int height, size_t max_pixels) {
  const Result<size_t> pixels = CheckedPixels(width, height, max_pixels);
  if (!pixels) return Fail("mask runs: " + pixels.error().message);
  uint64_t sum = 0;
  for (const uint32_t run : runs) sum += run;
  if (sum != *pixels) {
    return Fail("mask runs add up to " + std::to_string(sum) + "; expected " +
                std::to_string(width) + "x" + std::to_string(height) + " = " +
                std::to_string(*pixels));
  }
  PixelBox box;
  VisitInside(runs, height, [&](int u, int v0, int v1) { box.Include(v0, v1, u); });
  Mask mask = EmptyMask(width, height, box);
  VisitInside(runs, height, [&](int u, int v0, int v1) {
    for (int v = v0; v < v1; ++v) mask.inside(v - mask.v0, u - mask.u0) = 1;
  });
  return mask;
}

std::string RunsToString(std::span<const uint32_t> runs) {
  std::string text;
  for (size_t i = 0; i < runs.size(); ++i) {
    int64_t rest = runs[i];
    if (i > 2) rest -= runs[i - 2];
    bool more = true;
    while (more) {
      int64_t group = rest & 0x1f;
      rest >>= 5;
      // The highest bit of the last group is the sign.
      more = (group & 0x10) ? rest != -1 : rest != 0;
      if (more) group |= 0x20;
      text.push_back(static_cast<char>(group + '0'));
    }
  }
  return text;
}

Result<MaskRuns> RunsFromString(std::string_view text) {
  constexpr int kMaxShift = 35;  // 8 groups of 5 bits hold every difference of 32-bit runs
  MaskRuns runs;
  int64_t number = 0;
  int shift = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const int group = text[i] - '0';
    if (group < 0 || group > 63 || shift > kMaxShift) {
      return Fail("compressed mask counts: character " + std::to_string(i) +
                  " is not of this code");
    }
    number |= static_cast<int64_t>(group & 0x1f) << shift;
    shift += 5;
    if (group & 0x20) continue;
    if (group & 0x10) number -= int64_t{1} << shift;
    if (runs.size() > 2) number += runs[runs.size() - 2];
    if (number < 0 || number > UINT32_MAX) {
      return Fail("compressed mask counts: run " + std::to_string(runs.size()) + " is " +
                  std::to_string(number) + "; expected 0.." + std::to_string(UINT32_MAX));
    }
    runs.push_back(static_cast<uint32_t>(number));
    number = 0;
    shift = 0;
  }
  if (shift != 0) return Fail("compressed mask counts: the last number is cut off");
  return runs;
}

}  // namespace vismap
