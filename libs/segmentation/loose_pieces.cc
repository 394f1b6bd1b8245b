#include "segmentation/loose_pieces.h"

#include <utility>

#include "segmentation/at.h"
#include "segmentation/seen_through.h"

namespace vismap {
namespace {

/// A piece, without those of its runs that belong to a detected segment.
struct LoosePiece {
  std::vector<LooseRun> runs;
  int32_t pixels = 0;
  double depth_sum = 0;         ///< [m]
  std::vector<int32_t> inside;  ///< pixels that belong to each detection
};

bool HasDetection(const SegmentedFrame& frame, const LooseRun& run) {
  const SegmentIndex segment = frame.image.index(run.v, run.begin);
  return segment != SegmentIndex::kNone &&
         frame.segments[At(segment)].detection != DetectionIndex::kNone;
}

std::vector<LoosePiece> CollectPieces(const SegmentedFrame& frame,
                                      const PixelOwnership& ownership) {
  std::vector<LoosePiece> pieces;
  for (const LooseRun& run : frame.image.loose) {
    if (HasDetection(frame, run)) continue;
    if (At(run.piece) >= pieces.size()) pieces.resize(At(run.piece) + 1);
    LoosePiece& piece = pieces[At(run.piece)];
    piece.runs.push_back(run);
    piece.pixels += run.end - run.begin;
    piece.inside.resize(ownership.detection_count());
    for (int u = run.begin; u < run.end; ++u) {
      piece.depth_sum += frame.frame.depth(run.v, u);
      ownership.ForOwnersOf(run.v, u, [&](DetectionIndex k) { ++piece.inside[At(k)]; });
    }
  }
  std::erase_if(pieces, [](const LoosePiece& piece) { return piece.pixels == 0; });
  return pieces;
}

void MovePixels(const LoosePiece& piece, SegmentIndex to, SegmentedFrame* frame) {
  for (const LooseRun& run : piece.runs) {
    for (int u = run.begin; u < run.end; ++u) {
      SegmentIndex& segment = frame->image.index(run.v, u);
      if (segment != SegmentIndex::kNone) --frame->segments[At(segment)].pixels;
      segment = to;
    }
  }
  frame->segments[At(to)].pixels += piece.pixels;
}

}  // namespace

SegmentedFrame AttachLoosePieces(SegmentedFrame frame, const PixelOwnership& ownership,
                                 const std::vector<double>& depths, const RefineOptions& options) {
  const std::vector<SegmentIndex> largest =
      LargestSegments(frame.segments, ownership.detection_count());
  for (const LoosePiece& piece : CollectPieces(frame, ownership)) {
    for (const DetectionIndex k : ownership.ranking()) {
      const SegmentIndex to = largest[At(k)];
      if (to == SegmentIndex::kNone) continue;  // the detection has no segment to attach to
      if (piece.inside[At(k)] <= options.min_overlap * piece.pixels) continue;
      if (!IsWithinExtent(piece.depth_sum / piece.pixels, depths[At(to)], ownership.MaskOf(k),
                          frame.frame.header.camera, options.loose_depth_extent))
        continue;
      MovePixels(piece, to, &frame);
      break;
    }
  }
  return frame;
}

}  // namespace vismap
