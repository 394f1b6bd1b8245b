#pragma once

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

/// What one frame changed.
struct MapDelta {
  int64_t revision = 0;  ///< of the map after the frame
  std::vector<BlockIndex>
      changed_blocks;  ///< ascending; surface, labels or free space differ from before
  std::vector<NeighbourBits> affected;  ///< of each of them: AffectedBy the voxels that changed
  std::vector<std::pair<SegmentLabel, SegmentLabel>> merged;  ///< (dead, survivor), in order
  std::vector<InstanceSplit> split;                           ///< in order
  int64_t voxels_updated = 0;
  int64_t votes_evicted = 0;  ///< label votes lost to full slots
  /// Voxels of each label that were inside or on a surface and turned out to be free; ascending.
  std::map<SegmentLabel, uint32_t> cleared;

  BlockChanges changes() const { return {changed_blocks, affected}; }
};

struct IntegrationOptions {
  double min_range = 0.1;         ///< nearer returns are ignored [m along z]
  double max_range = 5.0;         ///< farther returns leave no surface, only free space [m along z]
  double free_space_range = 5.0;  ///< free space is recorded up to here [m along z]
  bool free_space = true;     ///< record seen-empty space; without it the map knows only surfaces
  double max_weight = 300.0;  ///< weight cap of a voxel, below 511; 1 = one observation at 1 m
  /// Blocks near surfaces that are kept as they are (7 kB each); of more, those out of view are
  /// packed into a fifth of that. Costs no exactness.
  int max_unpacked_blocks = 8000;
  /// Labels are voted for within this distance of the surface. With 1, what is only seen at a slant
  /// or from afar stays without label, and rims go to whoever's votes reach them.
  double vote_distance_voxels = 1.5;
  double merge_frames =
      3.0;  ///< net frames seen together after which two labels are merged; 0 = never
  double split_frames =
      2.0;  ///< net frames under different masks after which an instance is split; 0 = never

  /// Evidence of masks, in frames times score, from which on a label stands: frames that do not
  /// show it apart do not vote on its voxels (see MaskCuts); 0 = never.
  double mask_evidence = 2.0;
  int cut_votes = 2;  ///< a vote of such a label, where a mask cuts it out of another one, takes so
                      ///< many from that one

  // Carving: what was removed or moved goes when the camera sees past where it stood. A voxel that
  // rays clearly pass first only loses weight; its distance changes once little weight is left. So
  // a few wrong frames move no surface, and the heaviest one is gone after
  // ln(max_weight / weight of a frame) / -ln(carve_keep) + carve_frames + 2 frames.
  double carve_frames = 2.0;  ///< weight left, in frames like the present one; 0 = no carving
  /// A voxel far before any surface keeps no more weight than so many frames like the present one,
  /// so that what is put there later appears as fast; 0 = no such limit.
  double free_frames = 10.0;
  double carve_keep = 0.2;           ///< share of its weight that a voxel keeps each time, (0, 1)
  double carve_margin_voxels = 4.0;  ///< rays must end so far behind the voxel ...
  double carve_sigmas = 4.0;         ///< ... and so many deviations of the depth, see `noise`
  double carve_slope = 8.0;  ///< ... and so much farther per metre of its distance: a ray closer to
                             ///< parallel to the surface may have missed it
  DepthNoiseModel noise = KinectNoise();  ///< of the sensor; its disparity steps do not count
};

/// All problems of the options, as sentences; empty = fine.
std::vector<std::string> Validate(const IntegrationOptions& options);

/// The only function that changes a map: fuses one associated frame (Grinvald 2019, Sec. III-D).
/// Every voxel of the visible blocks is projected into the image once; the result does not depend
/// on the number of threads.
///
/// Departures from the published code: labels are voted for once per voxel and frame and only near
/// the surface, and not against what only masks can show; full vote slots evict; counts move along
/// when labels merge; merging weighs evidence against as well as for.
MapDelta IntegrateFrame(const SegmentedFrame& frame, const FrameAssociation& association,
                        const IntegrationOptions& options, SemanticMap* map);

}  // namespace vismap
