#pragma once

#include <vismap/rgbd_frame_t.hpp>

#include "foreign/frame_joiner.h"

namespace vismap {

/// The message of a joined frame, with the bytes of its images moved into it. The bus fills in seq,
/// source and checksum. `options` are those of the joiner. Colour in a zlib stream is unpacked by
/// the joiner, so that every format has its encoding.
rgbd_frame_t ToMessage(ForeignFrame&& frame, const AdapterCameraOptions& options);

}  // namespace vismap
