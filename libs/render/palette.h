#pragma once

#include "base/ids.h"
#include "geometry/image.h"
#include "meshing/mesh.h"

namespace vismap {

/// What the colours of a picture show.
enum class Coloring {
  kInstance,  ///< a strong colour per instance; a pale colour per segment without an instance
  kClass,     ///< a strong colour per class; a pale colour per segment without a class
  kSegment,   ///< a strong colour per segment
  kRgb,       ///< the colours that the camera saw
};

/// The colour of an id. An id has the same colour in every picture. The hues of successive ids
/// differ by the golden ratio. Id 0 is grey (kUnsegmentedColor).
Rgb8 StrongColor(uint32_t id);
Rgb8 PaleColor(uint32_t id);

/// The colour of a vertex in a picture with this colouring.
Rgb8 VertexColor(const MeshVertex& vertex, Coloring coloring);

/// The colour of a value in [0, 1]: the colour map "cividis", which reads the same for the
/// colour-blind. Values outside, and NaN, get the nearest end.
Rgb8 RampColor(double value);

/// Free, occupied and unknown space: colours of Okabe and Ito, which the colour-blind tell apart.
/// The viewer's page has the same.
inline constexpr Rgb8 kFreeColor{86, 180, 233};
inline constexpr Rgb8 kOccupiedColor{213, 94, 0};
inline constexpr Rgb8 kNotSeenColor{120, 120, 120};

/// The colour of surface without a segment.
inline constexpr Rgb8 kUnsegmentedColor{150, 150, 150};

}  // namespace vismap
