#pragma once

#include <utility>

#include "segmentation/detections.h"
#include "support/random_scenes.h"

namespace vismap::testing_support {

/// Up to eight rectangular masks, which may extend beyond the image.
inline DetectionSet RandomDetections(const PinholeCamera& camera, RandomNumbers* random) {
  DetectionSet set;
  for (int i = random->Whole(0, 8); i > 0; --i) {
    Detection detection{static_cast<ClassId>(random->Whole(1, 5)),
                        static_cast<float>(random->Real(0, 1)),
                        {camera.width,
                         camera.height,
                         random->Whole(-5, camera.width - 1),
                         random->Whole(-5, camera.height - 1),
                         {}}};
    detection.mask.inside =
        Image<uint8_t>(random->Whole(1, camera.width), random->Whole(1, camera.height), uint8_t{1});
    for (int holes = random->Whole(0, 20); holes > 0; --holes) {
      const Image<uint8_t>& inside = detection.mask.inside;
      detection.mask.inside(random->Whole(0, inside.height() - 1),
                            random->Whole(0, inside.width() - 1)) = 0;
    }
    set.detections.push_back(std::move(detection));
  }
  return set;
}

}  // namespace vismap::testing_support
