#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "association/associate.h"
#include "geometry/noise_model.h"
#include "map/block_rim.h"
#include "map/semantic_map.h"
#include "mapping/instance_split.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// What one frame changed in the map.
struct MapDelta {
  /// Why the map was not changed at all: one sentence; empty = the frame was integrated. Beyond the
  /// limits of IntegrationOptions, a frame is refused when more than 1000 segments are under masks.
  std::string refused;
  int64_t revision = 0;  ///< of the map after the frame
  /// Blocks whose surface, votes or free space changed, ascending.
  std::vector<BlockIndex> changed_blocks;
  /// Per changed block: the blocks around it whose mesh depends on the changed voxels, see
  /// AffectedBy.
  std::vector<NeighbourBits> affected;
  std::vector<std::pair<SegmentLabel, SegmentLabel>> merged;  ///< (dead, survivor), in order
  std::vector<InstanceSplit> split;                           ///< in order
  int64_t voxels_updated = 0;
  int64_t votes_evicted = 0;  ///< label votes that found all slots of their voxel taken
  /// Per label: voxels on or behind its surface that carving turned into free space.
  std::map<SegmentLabel, uint32_t> cleared;
  int64_t blocks_left_out = 0;  ///< new blocks that the map did not get, see max_map_mb

  BlockChanges changes() const { return {changed_blocks, affected}; }
};

struct IntegrationOptions {
  double min_range_m = 0.1;  ///< nearer depth is ignored [m along z]
  double max_range_m = 5.0;  ///< farther depth leaves no surface, only free space [m along z]
  double free_space_range_m = 5.0;  ///< free space is recorded up to here [m along z]
  bool free_space = true;           ///< false = the map holds surfaces only
  double max_weight = 300.0;        ///< cap of a voxel's weight, 1..511; 1 = one observation at 1 m
  /// Blocks with surface voxels that stay unpacked (7 kB each). When there are more, blocks that
  /// are out of view are packed to about a fifth, without loss.
  int max_unpacked_blocks = 8000;
  /// Pixels vote for their label up to this distance from the surface. With 1, surface that is only
  /// seen at a slant or from afar gets no label, or that of its neighbour.
  double vote_distance_voxels = 1.5;
  /// Two labels are merged once they were on one segment in this many more frames than on two; 0 =
  /// never.
  double merge_frames = 3.0;
  /// An instance is split once the bond of two of its labels is at most minus this, see
  /// SplitInstances; 0 = never.
  double split_frames = 2.0;

  /// A label with more evidence of masks than this [frames x score x overlap] is kept in frames
  /// that do not show it, see MaskCuts; 0 = never.
  double mask_evidence = 2.0;
  /// Where a mask cuts such a label out of another one, each vote for it removes so many votes for
  /// the other.
  int cut_votes = 2;

  // Carving: a surface that was removed or moved disappears once the camera measures depth clearly
  // behind it. Such a frame only reduces the weight of a heavy voxel; the distance changes once
  // little weight is left. So a few wrong frames move no surface, and even the heaviest one is gone
  // after ln(max_weight / weight of a frame) / -ln(carve_keep) + carve_frames + 2 frames.
  /// The weight is reduced to this many times the weight of the present frame; 0 = no carving.
  double carve_frames = 2.0;
  double carve_keep = 0.2;  ///< share of its weight that a heavy voxel keeps per frame, (0, 1)
  /// The measured depth must lie behind the voxel by at least this ...
  double carve_margin_voxels = 4.0;
  /// ... and by this many standard deviations of the depth, see `noise` ...
  double carve_sigmas = 4.0;
  /// ... and farther by this many times the voxel's own distance: a ray that is nearly parallel to
  /// a surface may pass in front of it.
  double carve_slope = 8.0;
  DepthNoiseModel noise = KinectNoise();  ///< of the sensor

  /// Radius of the window in which the noise of the depth is reduced before it makes surface [px],
  /// see SmoothDepth; 0 = depth as it was measured.
  int smooth_radius_px = 0;

  /// Counts the voxels in which readings of thin things end (ThinVoxels), so that they are not
  /// called free. Needs free_space.
  bool keep_thin = true;

  /// A voxel whose mean distance is at least 0.9 truncations keeps no more weight than this many
  /// frames like the present one, so that an object put there later appears as fast; 0 = no limit.
  double free_frames = 10.0;

  /// Memory of the map. Beyond, it gets no new blocks, and a frame that shows nothing else is
  /// refused. A frame may pass the limit by the blocks of its view that have to be unpacked.
  int max_map_mb = 2048;
  /// A frame is refused when it may change more blocks that a surface may pass near; blocks in free
  /// space count a sixteenth. At 1 cm voxels and 5 m, a Kinect sees 68000 blocks in all.
  int max_frame_blocks = 100000;
};

/// IntegrationOptions::max_map_mb [bytes].
inline size_t MaxMapBytes(const IntegrationOptions& options) {
  return static_cast<size_t>(options.max_map_mb) << 20;
}

/// All problems of the options, one sentence each; empty = valid.
std::vector<std::string> Validate(const IntegrationOptions& options);

/// Fuses one associated frame into the map (Grinvald 2019, Sec. III-D). No other function changes a
/// map. Every voxel of the visible blocks is projected into the image once; the result does not
/// depend on the number of threads. Limits on work and memory are checked before anything changes,
/// see MapDelta::refused. Formulas and departures from the published code are in
/// libs/METHOD.md, Integration.
MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map);

}  // namespace vismap
