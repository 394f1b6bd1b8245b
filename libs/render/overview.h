#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/class_names.h"
#include "objects/objects.h"
#include "render/drawing.h"
#include "render/render_mesh.h"

namespace vismap {

/// How an overview is drawn.
struct OverviewOptions {
  int width = 1600;  ///< [px]; >= 320
  int height = 900;  ///< [px]; >= 240
  Coloring coloring = Coloring::kInstance;
  /// Upward direction in W, unit length; not set = estimated from the surface (EstimateUp).
  std::optional<Eigen::Vector3d> up_W = std::nullopt;
  bool name_objects = true;  ///< write the class names at the objects in the perspective view
  /// What the colours mean when they are values (see PaintHeights); else there is a legend of the
  /// classes.
  std::optional<ColorScale> scale = std::nullopt;
};

/// One picture of a map: a perspective view on the left, a view from above on the right, and below
/// them a legend with the colours, the name and the number of objects of each class. `title` is at
/// the top. `mesh` and `objects` may be empty.
Image<Rgb8> RenderMapOverview(const Mesh& mesh, std::span<const ObjectSummary> objects,
                              const ClassNamer& class_name, const std::string& title,
                              const OverviewOptions& options = {});

/// What OverviewOptions says about the colours: a legend of classes or a scale.
Caption CaptionOf(std::span<const ObjectSummary> objects, const ClassNamer& class_name,
                  const std::string& title, const OverviewOptions& options);

/// Writes the class name at the centre of each object of a picture, in dark letters with a light
/// outline.
void NameObjects(std::span<const ObjectSummary> objects, const ClassNamer& class_name,
                 const View& view, Image<Rgb8>* image);

/// The legend of a picture: one entry per class in ascending order, with the number of its objects
/// and the first few of their colours; then instances without a class, discovered objects,
/// structure, and unsegmented surface. There are no swatches for Coloring::kRgb.
std::vector<LegendEntry> MakeLegend(std::span<const ObjectSummary> objects, Coloring coloring,
                                    const ClassNamer& class_name);

}  // namespace vismap
