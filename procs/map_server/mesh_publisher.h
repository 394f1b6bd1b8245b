#pragma once

#include <functional>
#include <string>
#include <vector>

#include "map_server/change_log.h"
#include "map_server/label_places.h"
#include "mapping/integrate.h"
#include "objects/block_surfaces.h"
#include "objects/read_out.h"
#include "runtime/bus.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Publishes a map's surface on MESH_DELTA: of the blocks whose shape changed, and of those whose
/// labels are read otherwise since (merged, another instance, another class).
class MeshPublisher {
 public:
  MeshPublisher(const MeshingOptions& options, Bus* bus) : options_(options), bus_(bus) {}

  /// From now on of this map; all of it counts as changed. Publishes nothing.
  void Start(const SemanticMap& map, const std::string& map_id);
  /// A frame changed the map.
  void NoteChanges(const SemanticMap& map, const MapDelta& delta);
  /// Where labels are, of all that was noted.
  const LabelPlaces& places() const { return places_; }
  /// What was published.
  const BlockSurfaces& surfaces() const { return surfaces_; }
  bool has_changes() const { return !dirty_.empty(); }

  /// What changed since the last time.
  void PublishChanges(const SemanticMap& map);
  /// Everything.
  void PublishAll(const SemanticMap& map);
  /// What a follower at this position lacks: the blocks that changed since, or everything.
  void PublishSince(const SemanticMap& map, const FollowerPosition& position);
  /// The present revision without a change, when nothing else was said for a second.
  void Heartbeat(const SemanticMap& map);

  /// Digest of the whole surface, made anew from the map; what followers have after PublishChanges.
  static std::string DigestOf(const SemanticMap& map, const MeshingOptions& options);

 private:
  using IsSent = std::function<bool(const BlockMesh&)>;

  // A block that changed, and which blocks that affects.
  struct Dirty {
    BlockIndex block;
    NeighbourBits affected;
  };

  void NoteDirty(const BlockChanges& changes);
  std::vector<BlockIndex> TakeBlocksToMesh(const VoxelMap& map);
  void AddBlocksShownOtherwise(const SemanticMap& map);
  bool NoteSurface(const SemanticMap& map, const BlockMesh& block);
  void Publish(const SemanticMap& map, int64_t base_revision, std::span<const BlockIndex> blocks,
               const IsSent& is_sent);

  MeshingOptions options_;
  Bus* bus_;
  std::string map_id_;
  int64_t revision_ = -1;          // of the last update
  std::vector<Dirty> dirty_;       // changed since, unsorted, some several times
  std::vector<ShownLabel> shown_;  // by label, at the last update
  BlockSurfaces surfaces_;         // at the last update
  LabelPlaces places_;
  ChangeLog log_;
  double last_published_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
