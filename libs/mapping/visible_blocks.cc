#include "mapping/visible_blocks.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace vismap {
namespace {

// The descent starts at cubes of 16 blocks, or at larger ones when the view would have more of them
// than this.
constexpr int kTopLevel = 4;
constexpr double kMaxTopCubes = 1e6;

size_t CostOf(const VisibleBlock& block) {
  return block.view == BlockVisibility::kMixed ? kCostPerBlock : 1;
}

struct Found {
  std::vector<VisibleBlock> blocks;
  size_t cost = 0;
};

class Descent {
 public:
  Descent(const FrameHeader& header, const DepthPyramid& pyramid, const VisibilityOptions& options,
          const std::function<bool(const VisibleBlock&)>& wanted)
      : camera_(header.camera),
        T_C_W_(header.T_W_C.inverse()),
        extent_(T_C_W_.linear().cwiseAbs().rowwise().sum() / 2),
        sides_(SidesOf(header.camera, T_C_W_.linear())),
        pyramid_(pyramid),
        options_(options),
        wanted_(wanted),
        range_(options.free_space ? std::max(options.max_range, options.free_space_range)
                                  : options.max_range) {}

  double range() const { return range_; }

  // Appends the visible blocks of the cube of 2^level blocks whose lowest block is `low`. Ends when
  // they cost too much.
  void Visit(BlockIndex low, int level, Found& visible) const {
    if (visible.cost > options_.max_cost) return;
    const BlockVisibility view = Classify(low, level);
    if (view == BlockVisibility::kNothing) return;
    if (level == 0) {
      Emit({low, view}, visible);
      return;
    }
    const int half = 1 << (level - 1);
    for (int child = 0; child < 8; ++child) {
      const BlockIndex corner{low.x + ((child >> 2) & 1) * half, low.y + ((child >> 1) & 1) * half,
                              low.z + (child & 1) * half};
      if (view == BlockVisibility::kWhollyFree) {
        EmitFree(corner, level - 1, visible);
      } else {
        Visit(corner, level - 1, visible);
      }
    }
  }

 private:
  void Emit(const VisibleBlock& block, Found& visible) const {
    if (!wanted_(block)) return;
    visible.blocks.push_back(block);
    visible.cost += CostOf(block);
  }

  void EmitFree(BlockIndex low, int level, Found& visible) const {
    if (visible.cost > options_.max_cost) return;
    const int side = 1 << level;
    for (int x = 0; x < side; ++x) {
      for (int y = 0; y < side; ++y) {
        for (int z = 0; z < side; ++z)
          Emit({{low.x + x, low.y + y, low.z + z}, BlockVisibility::kWhollyFree}, visible);
      }
    }
  }

  // What the frame can change in a cube, judged by its bounding box along the camera's axes.
  BlockVisibility Classify(BlockIndex low, int level) const {
    const double edge = options_.block_size * (1 << level);
    const Eigen::Vector3d center_W = Eigen::Vector3d(low.x, low.y, low.z) * options_.block_size +
                                     Eigen::Vector3d::Constant(edge / 2);
    const Eigen::Vector3d p = T_C_W_ * center_W;
    // The centres of the cube's voxels span a voxel less than its edge; a tenth of a voxel is added
    // for rounding.
    const double reach = edge - 0.9 * options_.block_size / kBlockSide;
    for (const Side& side : sides_) {
      if (side.normal_C.dot(p) + side.extent * reach < 0)
        return BlockVisibility::kNothing;  // beside the view
    }
    const Eigen::Vector3d half = extent_ * reach;
    const double z_near = p.z() - half.z(), z_far = p.z() + half.z();
    if (z_far < options_.min_range || z_near > range_ + options_.truncation)
      return BlockVisibility::kNothing;  // out of range
    // Cubes around the camera cannot be projected.
    if (z_near < 0.02)
      return level == 0 && z_far < 0.02 ? BlockVisibility::kNothing : BlockVisibility::kMixed;

    const auto [u_low, u_high] = Extent(p.x(), half.x(), z_near, z_far, camera_.fx, camera_.cx);
    const auto [v_low, v_high] = Extent(p.y(), half.y(), z_near, z_far, camera_.fy, camera_.cy);
    const double u_last = camera_.width - 1, v_last = camera_.height - 1;
    if (u_high < -0.5 || v_high < -0.5 || u_low > u_last + 0.5 || v_low > v_last + 0.5)
      return BlockVisibility::kNothing;  // outside the image
    const bool inside = u_low >= 0 && v_low >= 0 && u_high <= u_last && v_high <= v_last;

    const DepthRange depth = pyramid_.Bound(static_cast<int>(std::max(u_low, 0.0)),
                                            static_cast<int>(std::max(v_low, 0.0)),
                                            static_cast<int>(std::min(u_high + 1, u_last)),
                                            static_cast<int>(std::min(v_high + 1, v_last)));
    // No pixel has a depth, or the cube is hidden behind all that was measured.
    if (!(depth.farthest > 0) ||
        z_near > static_cast<double>(depth.farthest) + options_.truncation) {
      return BlockVisibility::kNothing;
    }
    const bool before_surface = z_far < static_cast<double>(depth.nearest) - options_.truncation;
    // Free space that the map does not record.
    if (before_surface && !options_.free_space) return BlockVisibility::kNothing;
    const bool in_range = z_near > options_.min_range && z_far < options_.free_space_range;
    if (!before_surface) return BlockVisibility::kMixed;
    return inside && depth.complete && in_range ? BlockVisibility::kWhollyFree
                                                : BlockVisibility::kPartlyFree;
  }

  // A plane through the camera's centre at one side of the image.
  struct Side {
    Eigen::Vector3d normal_C;  // inward; scaled so that normal_C . p_C / z is in pixels
    double extent;             // half extent of a cube with edge 1 along normal_C
  };

  static std::array<Side, 4> SidesOf(const PinholeCamera& camera, const Eigen::Matrix3d& R_C_W) {
    constexpr double kMargin = 1;  // half a pixel belongs to the image, the rest covers rounding
    const std::array<Eigen::Vector3d, 4> normals{
        Eigen::Vector3d(camera.fx, 0, camera.cx + kMargin),
        Eigen::Vector3d(-camera.fx, 0, camera.width - 1 + kMargin - camera.cx),
        Eigen::Vector3d(0, camera.fy, camera.cy + kMargin),
        Eigen::Vector3d(0, -camera.fy, camera.height - 1 + kMargin - camera.cy)};
    std::array<Side, 4> sides;
    for (size_t i = 0; i < sides.size(); ++i)
      sides[i] = {normals[i], (R_C_W.transpose() * normals[i]).cwiseAbs().sum() / 2};
    return sides;
  }

  // The pixels that a box can cover along one image axis, from and to.
  static std::pair<double, double> Extent(double x, double half, double z_near, double z_far,
                                          double focal, double center) {
    const double low = x - half, high = x + half;
    return {focal * std::min(low / z_near, low / z_far) + center,
            focal * std::max(high / z_near, high / z_far) + center};
  }

  const PinholeCamera& camera_;
  const Pose T_C_W_;
  const Eigen::Vector3d extent_;  // half extent along the camera's axes of a cube with edge 1
  const std::array<Side, 4> sides_;
  const DepthPyramid& pyramid_;
  const VisibilityOptions& options_;
  const std::function<bool(const VisibleBlock&)>& wanted_;
  const double range_;
};

// The box around the camera centre and the far corners of the view up to `range`.
Eigen::AlignedBox3d BoundsOfView(const FrameHeader& header, double range) {
  const PinholeCamera& camera = header.camera;
  Eigen::AlignedBox3d box(header.T_W_C.translation());
  for (const double u : {-0.5, camera.width - 0.5}) {
    for (const double v : {-0.5, camera.height - 0.5})
      box.extend(header.T_W_C * camera.BackProject(u, v, range));
  }
  return box;
}

int TopLevelFor(const Eigen::AlignedBox3d& box, double block_size) {
  int level = kTopLevel;
  while ((box.sizes() / (block_size * (1 << level))).array().prod() > kMaxTopCubes) ++level;
  return level;
}

// The cubes of 2^level blocks that a box can touch.
std::vector<BlockIndex> CubesIn(const Eigen::AlignedBox3d& box, double block_size, int level) {
  const double edge = block_size * (1 << level);
  const Eigen::Vector3i low = (box.min() / edge).array().floor().cast<int>() - 1;
  const Eigen::Vector3i high = (box.max() / edge).array().floor().cast<int>() + 1;
  std::vector<BlockIndex> cubes;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z)
        cubes.push_back({x << level, y << level, z << level});
    }
  }
  return cubes;
}

}  // namespace

size_t FrameCost(const std::vector<VisibleBlock>& visible) {
  size_t cost = 0;
  for (const VisibleBlock& block : visible) cost += block.view == BlockVisibility::kMixed ? 16 : 1;
  return cost;
}

std::vector<VisibleBlock> FindVisibleBlocks(
    const FrameHeader& header, const DepthPyramid& pyramid, const VisibilityOptions& options,
    const std::function<bool(const VisibleBlock&)>& wanted) {
  const Descent descent(header, pyramid, options, wanted);
  const Eigen::AlignedBox3d box = BoundsOfView(header, descent.range() + options.truncation);
  const int level = TopLevelFor(box, options.block_size);
  const std::vector<BlockIndex> cubes = CubesIn(box, options.block_size, level);
  std::vector<Found> parts(cubes.size());
  std::atomic<size_t> cost = 0;
  ParallelFor(cubes.size(), 1, [&](size_t i) {
    if (cost > options.max_cost) return;
    descent.Visit(cubes[i], level, parts[i]);
    if (parts[i].cost > 0) cost += parts[i].cost;
  });
  std::vector<VisibleBlock> visible;
  for (const Found& part : parts)
    visible.insert(visible.end(), part.blocks.begin(), part.blocks.end());
  std::sort(visible.begin(), visible.end(),
            [](const VisibleBlock& a, const VisibleBlock& b) { return a.index < b.index; });
  return visible;
}

}  // namespace vismap
