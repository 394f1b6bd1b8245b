#pragma once

#include "map/semantic_map.h"
#include "meshing/marching_cubes.h"
#include "meshing/mesh.h"

namespace vismap::naive {

/// The two voxels between which a vertex lies, and where: 0 at the lower one, 1 at the upper.
struct VertexEdge {
  VoxelIndex lower, upper;
  float t = 0;
};

/// Found from the vertex's position: along two axes it is that of voxel centres.
VertexEdge EdgeOf(const MeshVertex& vertex, const SemanticMap& map);

/// The colour there: between those of the two voxels, in 256ths; free blocks have none.
Rgb8 ColorAt(const VertexEdge& edge, const SemanticMap& map);

/// How many frames observed the surface there: by the nearer voxel, or by the other one when the
/// nearer is in a free block.
uint8_t SeenAt(const VertexEdge& edge, const SemanticMap& map);

/// The normal there: the gradient of the distance at the two voxels, interpolated and normalised;
/// one-sided differences where a neighbour is not observed. Along the edge toward free space where
/// the gradient is at most one step per voxel.
Eigen::Vector3f NormalAt(const VertexEdge& edge, const SemanticMap& map,
                         const MeshingOptions& options);

/// The label of the nearer end, else of the other one.
SegmentLabel LabelAtEnds(const VertexEdge& edge, const SemanticMap& map);

/// The label there, voxel by voxel: of the ends, else the most frequent one among the voxels that
/// share a face with an end, else among those that share a corner. Ties to the lower label.
SegmentLabel LabelAt(const VertexEdge& edge, const SemanticMap& map);

}  // namespace vismap::naive
