#include "session/derived_options.h"

namespace vismap {

void DeriveOptions(const SurfaceOptions& surface, MapSessionOptions* options) {
  options->association.min_range_m = options->integration.min_range_m;
  options->association.max_range_m = options->integration.max_range_m;
  options->integration.noise = surface.noise;
  options->depth = PrepareDepthOptionsOf(surface);
}

}  // namespace vismap
