#include "viewer/object_mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace vismap {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kNearest = 0.05F;  // [m]

// The arrays of an encoded block, see EncodePageBlock.
class BlockReader {
 public:
  explicit BlockReader(const SurfaceBlock& block)
      : bytes_(block.bytes->data()), vertices_(Read<uint32_t>(24)), triangles_(Read<uint32_t>(28)) {
    edge_ = static_cast<double>(Read<float>(16));
    corner_ = (Vector3d(block.index.x, block.index.y, block.index.z).array() - 0.5) * edge_;
    segments_ = kPageBlockHeader + size_t{16} * vertices_;
    indices_ = segments_ + size_t{8} * vertices_ + (size_t{2} * vertices_ + 3) / 4 * 4;
    wide_ = (Read<uint16_t>(2) & 1) != 0;
  }
  size_t vertices() const { return vertices_; }
  size_t triangles() const { return triangles_; }
  double edge() const { return edge_; }
  const Vector3d& corner_W() const { return corner_; }
  double step() const { return 2 * edge_ / 65535; }  // of a position [m]
  Vector3f Steps(size_t vertex) const {
    const size_t at = kPageBlockHeader + 8 * vertex;
    return {static_cast<float>(Read<uint16_t>(at)), static_cast<float>(Read<uint16_t>(at + 2)),
            static_cast<float>(Read<uint16_t>(at + 4))};
  }
  bool IsOf(const ObjectChoice& object, size_t vertex) const {
    const auto instance = Read<uint32_t>(segments_ + size_t{4} * (vertices_ + vertex));
    if (object.instance != InstanceId::kNone) return instance == Raw(object.instance);
    return instance == 0 && std::binary_search(object.segments.begin(), object.segments.end(),
                                               Read<uint32_t>(segments_ + 4 * vertex));
  }
  uint32_t Corner(size_t number) const {
    return wide_ ? Read<uint32_t>(indices_ + 4 * number) : Read<uint16_t>(indices_ + 2 * number);
  }

 private:
  template <typename Number>
  Number Read(size_t at) const {
    Number number;
    std::memcpy(&number, bytes_ + at, sizeof number);
    return number;
  }
  const uint8_t* bytes_;
  uint32_t vertices_, triangles_;
  double edge_ = 0;
  Vector3d corner_ = Vector3d::Zero();
  size_t segments_ = 0, indices_ = 0;
  bool wide_ = false;
};

// A vertex in the picture.
struct Spot {
  float u = 0, v = 0;
  float closeness = 0;  // linear over the picture; 0 = too near, or behind the camera
  bool is_object = false;
};

class MaskPainter {
 public:
  MaskPainter(const ObjectChoice& object, const PinholeCamera& camera, const Pose& T_W_C)
      : object_(object), camera_(camera), T_C_W_(T_W_C.inverse()) {
    mask_.visible = Image<uint8_t>(camera.width, camera.height);
    mask_.closeness = Image<float>(camera.width, camera.height);
    alone_ = Image<uint8_t>(camera.width, camera.height);
  }

  void Draw(const SurfaceBlock& encoded) {
    const BlockReader block(encoded);
    if (!MayBeSeen(block)) return;
    spots_.resize(block.vertices());
    const Eigen::Matrix3f turn = (T_C_W_.linear() * block.step()).cast<float>();
    const Vector3f shift = (T_C_W_ * block.corner_W()).cast<float>();
    for (size_t i = 0; i < block.vertices(); ++i) {
      spots_[i] = SpotOf(turn * block.Steps(i) + shift);
      spots_[i].is_object = block.IsOf(object_, i);
    }
    for (size_t i = 0; i < 3 * block.triangles(); i += 3)
      DrawTriangle(spots_[block.Corner(i)], spots_[block.Corner(i + 1)],
                   spots_[block.Corner(i + 2)]);
  }

  ObjectMask Finish() {
    const auto count = [](const Image<uint8_t>& image) {
      return static_cast<int>(std::count(image.pixels().begin(), image.pixels().end(), 1));
    };
    mask_.pixels = count(mask_.visible);
    mask_.pixels_alone = count(alone_);
    return std::move(mask_);
  }

 private:
  // False when the ball around the block lies outside of what the camera sees.
  bool MayBeSeen(const BlockReader& block) const {
    const Vector3d center = T_C_W_ * (block.corner_W() + Vector3d::Constant(block.edge()));
    const double radius = std::sqrt(3.0) * block.edge();
    const double z = center.z() + radius;
    if (z < static_cast<double>(kNearest)) return false;
    const auto beside = [&](double x, double low_px, double high_px, double focal) {
      const double low = low_px / focal, high = high_px / focal;  // tangents
      return x - low * center.z() < -radius * std::hypot(1, low) ||
             x - high * center.z() > radius * std::hypot(1, high);
    };
    return !beside(center.x(), -camera_.cx - 1, camera_.width - camera_.cx, camera_.fx) &&
           !beside(center.y(), -camera_.cy - 1, camera_.height - camera_.cy, camera_.fy);
  }

  Spot SpotOf(const Vector3f& p_C) const {
    if (!(p_C.z() > kNearest)) return {};
    const float closeness = 1 / p_C.z();
    return {static_cast<float>(camera_.fx) * p_C.x() * closeness + static_cast<float>(camera_.cx),
            static_cast<float>(camera_.fy) * p_C.y() * closeness + static_cast<float>(camera_.cy),
            closeness};
  }

  static float Cross(const Spot& a, const Spot& b, float u, float v) {
    return (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
  }

  void DrawTriangle(const Spot& a, const Spot& b, const Spot& c) {
    if (!(a.closeness > 0) || !(b.closeness > 0) || !(c.closeness > 0)) return;
    const float area = Cross(a, b, c.u, c.v);
    if (area == 0) return;
    const bool is_object = a.is_object + b.is_object + c.is_object >= 2;
    const int u_begin = First(std::min({a.u, b.u, c.u})),
              v_begin = First(std::min({a.v, b.v, c.v}));
    const int u_end = Last(std::max({a.u, b.u, c.u}), camera_.width);
    const int v_end = Last(std::max({a.v, b.v, c.v}), camera_.height);
    for (int v = v_begin; v <= v_end; ++v) {
      for (int u = u_begin; u <= u_end; ++u) {
        const auto x = static_cast<float>(u), y = static_cast<float>(v);
        const float wa = Cross(b, c, x, y) / area, wb = Cross(c, a, x, y) / area;
        const float wc = 1 - wa - wb;
        if (wa < 0 || wb < 0 || wc < 0) continue;
        Put(v, u, wa * a.closeness + wb * b.closeness + wc * c.closeness, is_object);
      }
    }
  }

  void Put(int v, int u, float closeness, bool is_object) {
    if (is_object) alone_(v, u) = 1;
    if (closeness <= mask_.closeness(v, u)) return;
    mask_.closeness(v, u) = closeness;
    mask_.visible(v, u) = is_object ? 1 : 0;
  }

  // The first and the last pixel centre in a range, within the picture.
  static int First(float from) {
    return static_cast<int>(std::ceil(std::clamp(from, 0.0F, static_cast<float>(kMaxImageSide))));
  }
  static int Last(float to, int size) {
    return static_cast<int>(std::floor(std::clamp(to, -1.0F, static_cast<float>(size - 1))));
  }

  const ObjectChoice& object_;
  const PinholeCamera& camera_;
  Pose T_C_W_;
  ObjectMask mask_;
  Image<uint8_t> alone_;
  std::vector<Spot> spots_;  // of one block
};

}  // namespace

std::vector<Vector3f> SampleObject(std::span<const SurfaceBlock> blocks, const ObjectChoice& object,
                                   size_t most) {
  std::vector<Vector3f> points;
  for (const SurfaceBlock& encoded : blocks) {
    const BlockReader block(encoded);
    for (size_t i = 0; i < block.vertices(); ++i) {
      if (!block.IsOf(object, i)) continue;
      points.push_back(
          (block.corner_W() + block.step() * block.Steps(i).cast<double>()).cast<float>());
    }
  }
  if (points.size() <= most) return points;
  std::vector<Vector3f> chosen;
  for (size_t i = 0; i < most; ++i) chosen.push_back(points[i * points.size() / most]);
  return chosen;
}

ObjectMask DrawObjectMask(std::span<const SurfaceBlock> blocks, const ObjectChoice& object,
                          const PinholeCamera& camera, const Pose& T_W_C) {
  MaskPainter painter(object, camera, T_W_C);
  for (const SurfaceBlock& block : blocks) painter.Draw(block);
  return painter.Finish();
}

PinholeCamera SmallerCamera(const PinholeCamera& camera, int step) {
  return {(camera.width + step - 1) / step,
          (camera.height + step - 1) / step,
          camera.fx / step,
          camera.fy / step,
          camera.cx / step,
          camera.cy / step};
}

bool FitsMeasured(const Image<uint16_t>& depth_mm, int row, int column, double depth) {
  const double tolerance = std::max(0.05, 0.03 * depth);
  bool measured = false;
  for (int v = row - 1; v <= row + 1; ++v) {
    for (int u = column - 1; u <= column + 1; ++u) {
      if (!depth_mm.Contains(v, u) || depth_mm(v, u) == 0) continue;
      if (std::abs(depth - depth_mm(v, u) * 0.001) <= tolerance) return true;
      measured = true;
    }
  }
  return !measured;
}

void KeepMeasured(const Image<uint16_t>& depth_mm, int depth_step, int mask_step,
                  ObjectMask* mask) {
  const auto fits = [&](int v, int u) {
    return FitsMeasured(depth_mm, (v * mask_step + depth_step / 2) / depth_step,
                        (u * mask_step + depth_step / 2) / depth_step,
                        1 / static_cast<double>(mask->closeness(v, u)));
  };
  for (int v = 0; v < mask->visible.height(); ++v) {
    for (int u = 0; u < mask->visible.width(); ++u) {
      if (mask->visible(v, u) == 0 || fits(v, u)) continue;
      mask->visible(v, u) = 0;
      --mask->pixels;
    }
  }
}

}  // namespace vismap
