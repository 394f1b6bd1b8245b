#pragma once

#include "detection/letterbox.h"
#include "detection/tensor.h"
#include "geometry/image.h"

namespace vismap {

/// 1x3xHxW, RGB in [0, 1], the image laid in by `letterbox`, padding 114/255, as YOLO is trained.
Tensor YoloInput(const Image<Rgb8>& color, const Letterbox& letterbox);

/// 1x3xHxW, RGB in [0, 255], the image resized as `letterbox` says, without padding.
Tensor MaskRcnnInput(const Image<Rgb8>& color, const Letterbox& letterbox);

}  // namespace vismap
