#pragma once

#include <cstdint>
#include <optional>

#include "exports/outputs.h"
#include "requests/request_server.h"

namespace vismap {

/// What a request for an octree asks for; its values have been checked.
struct OctreeRequest {
  OctreeOptions tree;    ///< its resolution is that of a leaf, never 0
  double inflate_m = 0;  ///< see octree_t.inflated_by_m [m]
  bool color = false;    ///< a ColorOcTree

  /// The blocks that the tree depends on, of this edge [m]; nullopt = all.
  std::optional<BlockRegion> Region(double block_size) const;
};

/// Reads a request for an octree of a map with voxels of `voxel_size` [m]. `defaults` holds what
/// the request does not state; the policy is closed when it states none. Fails with a sentence that
/// names the field, what was found and what is allowed: on a resolution or radius that is not
/// finite, negative or no multiple of the voxel size, on a policy or kind of tree that does not
/// exist, on a box that is not finite, inverted or empty, and on an argument.
Result<OctreeRequest> ReadOctreeRequest(const map_request_t& request, double voxel_size,
                                        const OctreeOptions& defaults);

/// The edge of a leaf that a request states, or `usual`, see OctreeOptions::resolution_m [m]. Fails
/// as ReadOctreeRequest.
Result<double> ReadLeaf(const map_request_t& request, double voxel_size, double usual);
/// The box that a request states; nullopt = none. Fails as ReadOctreeRequest.
Result<std::optional<Eigen::AlignedBox3d>> ReadBox(const map_request_t& request);

/// The tree of a map, which must hold at least the blocks of OctreeRequest::Region, as an answer.
/// `utime` is that of the newest frame in the map [us]. A closed tree of a box in which nothing is
/// known is full of occupied space, and the message says so. Fails on a map or a raw tree in which
/// nothing is known, and as BuildOctree.
Result<Answer> AnswerOctree(const OccupancyMap& map, const OctreeRequest& request, int64_t utime);

/// The tree of a map, without its FarParts, as an answer; also a ColorOcTree. Only the blocks of
/// the box are classified. `edited`: the blocks that differ for request.without (EditSpace), which
/// must be given when that is not empty.
Result<Answer> AnswerMapOctree(const SemanticMap& map, const MapMetadata& metadata,
                               const map_request_t& request, const OutputOptions& options,
                               const OccupancyDelta* edited = nullptr);

/// The message and the facts for a tree; without its bytes.
Answer DescribeOctree(const OctreeBytes& octree, const OctreeRequest& request, int64_t utime);

}  // namespace vismap
