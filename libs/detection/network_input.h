#pragma once

#include "detection/letterbox.h"
#include "detection/tensor.h"
#include "geometry/image.h"

namespace vismap {

/// The input of YOLO: 1x3xHxW, RGB in [0, 1], with the image placed by `letterbox` and padding of
/// 114/255, as in the training.
Tensor YoloInput(const Image<Rgb8>& color, const Letterbox& letterbox);

/// The input of Mask R-CNN: 1x3xHxW, RGB in [0, 255], with the image in the size of `letterbox` and
/// without padding.
Tensor MaskRcnnInput(const Image<Rgb8>& color, const Letterbox& letterbox);

}  // namespace vismap
