#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/class_names.h"
#include "objects/objects.h"
#include "render/render_mesh.h"

namespace vismap {

struct OverviewOptions {
  int width = 1600;
  int height = 900;
  Coloring coloring = Coloring::kInstance;
  /// Up direction, unit; nullopt = estimated from the surfaces (see EstimateUp).
  std::optional<Eigen::Vector3d> up_W = std::nullopt;
  bool name_objects = true;  ///< class names beside the objects in the perspective view
};

/// One picture of a map for people: in perspective on the left, from above on the right, and below
/// them what the colours mean (a swatch, the class name and the number of objects per class).
/// `title` stands at the top. `mesh` and `objects` may be empty.
Image<Rgb8> RenderMapOverview(const Mesh& mesh, std::span<const ObjectSummary> objects,
                              const ClassNamer& class_name, const std::string& title,
                              const OverviewOptions& options = {});

/// A line of a legend: up to a few swatches, then the text.
struct LegendEntry {
  std::vector<Rgb8> swatches;
  std::string text;
};

/// What the colours of a picture mean: one entry per class in ascending order, with the number of
/// its objects (and, coloured by instance, their colours); then unknown objects and the rest.
std::vector<LegendEntry> MakeLegend(std::span<const ObjectSummary> objects, Coloring coloring,
                                    const ClassNamer& class_name);

}  // namespace vismap
