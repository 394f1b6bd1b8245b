#pragma once

#include <vector>

#include "viewer/page_messages.h"

namespace vismap {

/// The blocks that changed in what a page is to show.
struct SurfaceChanges {
  bool reset = false;  ///< another map: all blocks that a page has are wrong
  std::vector<BlockIndex>
      blocks;  ///< changed, new or gone, ascending; of the new map after a reset
};

/// The surface that a page is to show: that of the live map, or of a moment of a log.
class SurfaceView {
 public:
  virtual ~SurfaceView() = default;
  /// See EncodePageBlock; nullptr when the block has no surface.
  virtual FrameBytes BytesOf(BlockIndex index) = 0;
  /// All blocks with a surface, ascending.
  virtual std::vector<BlockIndex> SortedIndices() const = 0;
  virtual double block_edge_m() const = 0;  ///< 0 = no block yet
  virtual int64_t revision() const = 0;     ///< of the map
  /// The page forgets all blocks that it has got.
  virtual void OnForget() {}
};

}  // namespace vismap
