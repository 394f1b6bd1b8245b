#pragma once

#include "base/ids.h"
#include "geometry/image.h"
#include "meshing/mesh.h"

namespace vismap {

/// What the colours of a picture mean.
enum class Coloring {
  kInstance,  ///< strong colours: one per instance; pale: one per segment without an instance
  kClass,     ///< strong colours: one per class; pale: one per segment without a class
  kSegment,   ///< strong colours: one per segment
  kRgb,       ///< as the camera saw it
};

/// Colours are fixed for ever: the same id has the same colour in every picture. Neighbouring ids
/// differ by the golden ratio in hue. Id 0 is grey.
Rgb8 StrongColor(uint32_t id);
Rgb8 PaleColor(uint32_t id);

Rgb8 VertexColor(const MeshVertex& vertex, Coloring coloring);

/// Colour of surface that belongs to no segment.
inline constexpr Rgb8 kNobodyColor{150, 150, 150};

}  // namespace vismap
