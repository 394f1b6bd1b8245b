#include "pictures/report_space.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "pictures/html.h"
#include "pictures/octree_picture.h"
#include "pictures/slice_picture.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr double kRobotHeight = 0.5;  // of the slice above the floor [m]

// The axis of W that is nearest to up.
int UpAxis(const Vector3d& up_W) {
  Eigen::Index axis = 0;
  up_W.cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(axis);
}

// Along up [m].
struct FloorHeight {
  double height = 0;
  bool found = false;  // false = no floor was found, and this is the lowest surface
};

FloorHeight FindFloor(const MapProducts& products, const SceneBox& scene) {
  const Vector3d& up_W = products.up.up_W;
  FloorHeight floor{scene.center_W.dot(up_W) - scene.size.z() / 2, false};
  for (const ObjectSummary& object : products.objects) {
    if (object.removed() || object.structure != StructureKind::kFloor) continue;
    const double height = object.plane.point_W.dot(up_W);
    floor = {floor.found ? std::min(floor.height, height) : height, true};
  }
  return floor;
}

std::string VolumesHtml(const OccupancyMap& space, const OccupancyBox& known) {
  const CellCounts cells = CountCells(space);
  const double all = static_cast<double>(known.max.x - known.min.x) *
                     static_cast<double>(known.max.y - known.min.y) *
                     static_cast<double>(known.max.z - known.min.z);
  const double cell = std::pow(space.cell_size(), 3);
  HtmlTable table({"space", "volume [m&sup3;]", "share of the box around all that is known"});
  const auto add = [&](const char* state, double count) {
    table.Add({state, Digits(count * cell, 2), Escaped(FormatPercent(count / all))});
  };
  add("free", static_cast<double>(cells.free));
  add("occupied", static_cast<double>(cells.occupied));
  add("unknown", all - static_cast<double>(cells.free) - static_cast<double>(cells.occupied));
  return table.Html();
}

std::string SliceHtml(const OccupancyMap& space, const MapProducts& products, const SceneBox& scene,
                      const PictureSize& size) {
  const Vector3d& up_W = products.up.up_W;
  const FloorHeight floor = FindFloor(products, scene);
  const double rise = floor.height + kRobotHeight - scene.center_W.dot(up_W);
  SlicePictureOptions options;
  options.width = size.width;
  options.height = size.height;
  SliceQuestion question;
  question.axis = UpAxis(up_W);
  question.at_m = (scene.center_W + rise * up_W)[question.axis];
  question.cell_m = SliceCellFor(space, question.axis, options);
  const Result<Slice> slice = CutSlice(space, question);
  if (!slice) return Remark(slice.error().message);
  const std::string place =
      std::string(1, "xyz"[question.axis]) + " = " + MetresText(question.at_m);
  return PngFigure(RenderSlice(*slice, question, "Slice at " + place, options),
                   "Free, occupied and unknown space " + Digits(kRobotHeight, 1) + " m above the " +
                       (floor.found ? "floor" : "lowest surface (no floor was found)") +
                       " in the middle of the map, at " + Escaped(place));
}

std::string OctreeHtml(const OccupancyMap& space, const Vector3d& up_W,
                       const OctreeOptions& options, const PictureSize& size) {
  const auto octree = BuildOctree(space, options);
  if (!octree) return Remark("There is no octree: " + octree.error().message);
  const auto leaves = ReadOctree(octree->bytes, "octree");
  if (!leaves) return Remark("There is no octree: " + leaves.error().message);
  const auto cubes = MakeLeafCubes(*leaves, {.up_W = up_W});
  if (!cubes) return Remark("The octree is not drawn: " + cubes.error().message);
  const int rows = size.height - kTitleRows - LegendRows(size.height);
  const View view =
      BestPerspectiveView(cubes->mesh, FrameScene(cubes->mesh, up_W), size.width, rows);
  return WebpFigure(WithCaption(RenderMesh(cubes->mesh, view, Coloring::kRgb),
                                CubesCaption(*cubes, "Octree"), size.height),
                    "The octree that planners get");
}

}  // namespace

std::string SpaceHtml(const OccupancyMap& space, const MapProducts& products, const SceneBox& scene,
                      const OctreeOptions& octree, const PictureSize& size) {
  const auto known = space.KnownCells();
  if (!known) return Remark("Nothing is known of the space of this map.");
  return VolumesHtml(space, *known) + SliceHtml(space, products, scene, size) +
         OctreeHtml(space, products.up.up_W, octree, size);
}

}  // namespace vismap
