#include <algorithm>
#include <map>

#include "base/require.h"
#include "codecs/mask_codec.h"
#include "simulation/random.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

/// The object's pixels with room to grow by `margin` around them, as far as the image goes.
Mask Cut(const Image<uint16_t>& ids, uint16_t id, const Eigen::AlignedBox2i& box, int margin) {
  const int u0 = std::max(box.min().x() - margin, 0);
  const int v0 = std::max(box.min().y() - margin, 0);
  const int u1 = std::min(box.max().x() + 1 + margin, ids.width());
  const int v1 = std::min(box.max().y() + 1 + margin, ids.height());
  Mask mask{.image_width = ids.width(),
            .image_height = ids.height(),
            .u0 = u0,
            .v0 = v0,
            .inside = Image<uint8_t>(u1 - u0, v1 - v0)};
  for (int v = v0; v < v1; ++v) {
    for (int u = u0; u < u1; ++u) mask.inside(v - v0, u - u0) = ids(v, u) == id;
  }
  return mask;
}

/// Every pixel takes `value` when one within `radius` (a square around it) has it.
Image<uint8_t> Spread(const Image<uint8_t>& image, uint8_t value, int radius) {
  Image<uint8_t> spread = image;
  for (int v = 0; v < image.height(); ++v) {
    for (int u = 0; u < image.width(); ++u) {
      if (image(v, u) != value) continue;
      for (int y = std::max(v - radius, 0); y <= std::min(v + radius, image.height() - 1); ++y) {
        for (int x = std::max(u - radius, 0); x <= std::min(u + radius, image.width() - 1); ++x) {
          spread(y, x) = value;
        }
      }
    }
  }
  return spread;
}

std::map<uint16_t, std::pair<int, Eigen::AlignedBox2i>> MeasureObjects(const Image<uint16_t>& ids) {
  std::map<uint16_t, std::pair<int, Eigen::AlignedBox2i>> objects;
  for (int v = 0; v < ids.height(); ++v) {
    for (int begin = 0, end = 0; begin < ids.width(); begin = end) {
      while (end < ids.width() && ids(v, end) == ids(v, begin)) ++end;
      auto& [pixels, box] = objects[ids(v, begin)];
      pixels += end - begin;
      box.extend(Eigen::Vector2i(begin, v)).extend(Eigen::Vector2i(end - 1, v));
    }
  }
  return objects;
}

/// The same box as MaskFromImage gives: tight.
Mask Tight(const Mask& mask) {
  Mask tight = MaskFromImage(mask.inside);
  tight.image_width = mask.image_width;
  tight.image_height = mask.image_height;
  if (tight.inside.empty()) return tight;
  tight.u0 += mask.u0;
  tight.v0 += mask.v0;
  return tight;
}

}  // namespace

DetectionSet SimulateDetections(const Scene& scene, const Image<uint16_t>& object_ids,
                                const FrameHeader& header, const DetectorNoise& noise) {
  Require(noise.max_mask_error >= 0, "mask errors are not negative");
  DetectionSet set{header.utime, header.camera_id, header.frame_number, {}};
  const double min_pixels =
      noise.min_pixels * static_cast<double>(object_ids.size()) / (640.0 * 480.0);
  const uint64_t frame_key = Mix(noise.seed, static_cast<uint64_t>(header.frame_number));
  for (const auto& [id, measured] : MeasureObjects(object_ids)) {
    const auto& [pixels, box] = measured;
    const SceneObject* object = FindObject(scene, id);
    if (object == nullptr || object->kind != ObjectKind::kKnown || pixels < min_pixels) continue;
    const uint64_t key = Mix(frame_key, id);
    if (Uniform(Mix(key, 1)) < noise.miss_rate) continue;
    const int error = static_cast<int>(Uniform(Mix(key, 2)) * (2 * noise.max_mask_error + 1)) -
                      noise.max_mask_error;
    Mask mask = Cut(object_ids, id, box, noise.max_mask_error + 1);
    mask.inside = Spread(mask.inside, error > 0 ? 1 : 0, std::abs(error));
    mask = Tight(mask);
    if (mask.inside.empty()) continue;
    const auto score = static_cast<float>(0.6 + 0.4 * Uniform(Mix(key, 3)));
    set.detections.push_back({object->class_id, score, std::move(mask)});
  }
  return set;
}

}  // namespace vismap
