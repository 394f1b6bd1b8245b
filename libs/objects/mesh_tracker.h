#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "map/semantic_map.h"
#include "meshing/marching_cubes.h"
#include "objects/block_surfaces.h"
#include "objects/change_log.h"
#include "objects/dirty_blocks.h"
#include "objects/label_places.h"

namespace vismap {

/// One part of an update of a map's surface.
struct MeshPart {
  int64_t base_revision = -1;  ///< the receiver must have this revision; -1 = the whole surface
  int64_t revision = 0;        ///< which the receiver has after all parts
  size_t part = 0;             ///< this is part 0..parts-1 of the update
  size_t parts = 1;
  std::vector<BlockMesh> blocks;  ///< ascending; without triangles = the block has no surface now
};

/// What a follower lacks: blocks to be meshed, see MeshBlocksOf.
struct MeshGap {
  int64_t base_revision = -1;      ///< as in MeshPart
  int64_t revision = 0;            ///< of the map whose blocks must be meshed
  std::vector<BlockIndex> blocks;  ///< in any order
  std::vector<ShownLabel> shown;   ///< by label
};

/// Keeps the surface of a growing map up to date for followers: which blocks must be meshed again,
/// because their shape or what their labels show has changed, and which blocks a follower lacks.
/// Keeps what objects are read from as well (see ObjectTracker).
class MeshTracker {
 public:
  /// Receives an update part by part, in order, at least one: only some megabytes of mesh are in
  /// memory at a time.
  using Receiver = std::function<void(MeshPart)>;

  explicit MeshTracker(const MeshingOptions& options) : options_(options) {}

  /// Starts with a map, all of which counts as changed.
  void Start(const SemanticMap& map);
  /// A frame changed these blocks and merged these labels, as (dead, survivor).
  void AddChanges(const SemanticMap& map, const BlockChanges& changes,
                  std::span<const std::pair<SegmentLabel, SegmentLabel>> merged);
  /// Blocks have changed since the last update.
  bool has_changes() const { return !dirty_.empty(); }
  /// Of the last update; -1 = there was none yet.
  int64_t revision() const { return revision_; }

  /// Updates from the last revision to the present one; the first update is the whole surface.
  void MeshChanges(const SemanticMap& map, const Receiver& receive);
  /// Updates to the present revision with the whole surface.
  void MeshAll(const SemanticMap& map, const Receiver& receive);
  /// Updates as MeshChanges does, then hands over what a follower with `revision` of this map
  /// lacks: the blocks that changed since, or the whole surface when that is not known.
  void MeshSince(const SemanticMap& map, int64_t revision, const Receiver& receive);
  /// Updates as MeshChanges does, and tells what the follower lacks then. The map as it is now, or
  /// a copy of it, has the surface.
  MeshGap GapSince(const SemanticMap& map, int64_t revision, const Receiver& receive);

  /// The surface of each label, at the last update.
  const BlockSurfaces& surfaces() const { return surfaces_; }
  /// The blocks of each label, with all changes so far.
  const LabelPlaces& places() const { return places_; }
  /// Memory [bytes], about.
  size_t bytes() const {
    return dirty_.bytes() + shown_.capacity() * sizeof(ShownLabel) + surfaces_.bytes() +
           places_.bytes() + log_.bytes();
  }

 private:
  void AddBlocksShownDifferently(const SemanticMap& map);
  bool RecordSurface(const SemanticMap& map, const BlockMesh& block);
  void Mesh(const SemanticMap& map, int64_t base_revision, std::span<const BlockIndex> blocks,
            const std::function<bool(const BlockMesh&)>& is_handed_over, const Receiver& receive);

  MeshingOptions options_;
  int64_t revision_ = -1;
  DirtyBlocks dirty_;
  std::vector<ShownLabel> shown_;  // by label, at the last update
  BlockSurfaces surfaces_;
  LabelPlaces places_;
  ChangeLog log_;
};

/// Meshes what a follower lacks; hands it over part by part.
void MeshBlocksOf(const MeshGap& gap, const SemanticMap& map, const MeshingOptions& options,
                  const MeshTracker::Receiver& receive);

/// Meshes the whole map block by block, as followers get it. Hands the blocks over in ascending
/// order, some hundreds at a time.
void MeshWholeMap(const SemanticMap& map, const MeshingOptions& options,
                  const std::function<void(std::vector<BlockMesh>)>& receive);

}  // namespace vismap
