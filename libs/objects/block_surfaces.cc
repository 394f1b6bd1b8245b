#include "objects/block_surfaces.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "meshing/mesh_parts.h"
#include "objects/keep_share.h"

namespace vismap {
namespace {

constexpr double kSteps = 32;  // resolution of the sampled vertices [steps per voxel]
// The same share of the vertices is kept in every block, so that no part of an object has more
// weight than another.
constexpr double kShareKept = 0.5;
// Marching cubes keeps vertices at least this far from voxel centres [voxels]. Half of it is the
// tolerance for rounding when a vertex is assigned to a block.
constexpr double kNearestVertex = 0.01;

// The centre of a block's first voxel [m].
Eigen::Vector3d FirstCenter(const BlockIndex& block, double voxel_size) {
  return (Eigen::Vector3d(block.x, block.y, block.z) * kBlockSide).array() * voxel_size +
         0.5 * voxel_size;
}

// The offset of a vertex from the centre of the first voxel, in 1/32 of a voxel. None for a vertex
// on the face to the next block, because the mesh of that block has it, too.
std::optional<std::array<uint8_t, 3>> OffsetInBlock(const Eigen::Vector3d& from_first_m,
                                                    double voxel_size) {
  const Eigen::Array3d voxels = from_first_m.array() / voxel_size + kNearestVertex / 2;
  if ((voxels >= kBlockSide).any()) return std::nullopt;
  const Eigen::Array3d steps = (voxels.max(0.0) * kSteps).floor();
  return std::array<uint8_t, 3>{static_cast<uint8_t>(steps.x()), static_cast<uint8_t>(steps.y()),
                                static_cast<uint8_t>(steps.z())};
}

}  // namespace

void BlockSurfaces::Clear() {
  blocks_.clear();
  amounts_.clear();
  piece_bytes_ = 0;
}

size_t BlockSurfaces::BytesOf(const std::vector<Piece>& pieces) {
  constexpr size_t kAllocation = 16;
  size_t bytes = kAllocation + pieces.capacity() * sizeof(Piece);
  for (const Piece& piece : pieces) bytes += kAllocation + piece.points.capacity() * sizeof(Point);
  return bytes;
}

size_t BlockSurfaces::bytes() const {
  constexpr size_t kEntry = sizeof(BlockIndex) + sizeof(std::vector<Piece>) + 12;
  return blocks_.bucket_count() * kEntry + piece_bytes_ + amounts_.capacity() * sizeof(Amount);
}

std::vector<BlockSurfaces::Piece> BlockSurfaces::PiecesOf(const BlockMesh& block,
                                                          double voxel_size) {
  std::vector<Piece> pieces;
  const auto piece_of = [&](SegmentLabel label) -> Piece& {
    const auto found = std::find_if(pieces.begin(), pieces.end(),
                                    [&](const Piece& piece) { return piece.label == label; });
    if (found != pieces.end()) return *found;
    pieces.push_back({label, 0, 0, {}});
    return pieces.back();
  };
  const Eigen::Vector3d first_W = FirstCenter(block.block, voxel_size);
  for (const MeshVertex& vertex : block.mesh.vertices) {
    const auto place = OffsetInBlock(vertex.position_W.cast<double>() - first_W, voxel_size);
    if (!place) continue;
    Piece& piece = piece_of(vertex.segment);
    ++piece.vertices;
    piece.points.push_back(*place);
  }
  // Each corner gives a third of the triangle's area to its label.
  for (size_t i = 0; i < block.mesh.triangles.size(); ++i) {
    const double third = TriangleArea(block.mesh, i) / 3;
    for (const uint32_t corner : block.mesh.triangles[i])
      piece_of(block.mesh.vertices[corner].segment).area += third;
  }
  for (Piece& piece : pieces) {
    KeepShare(kShareKept, &piece.points);
    piece.points.shrink_to_fit();
  }
  pieces.shrink_to_fit();
  return pieces;
}

void BlockSurfaces::Count(const Piece& piece, int sign) {
  if (amounts_.size() <= Raw(piece.label)) amounts_.resize(Raw(piece.label) + 1);
  Amount& amount = amounts_[Raw(piece.label)];
  amount.vertices += sign * static_cast<int64_t>(piece.vertices);
  // Areas are multiples of 2^-40 m^2, which add up without rounding errors. So the sum is exactly 0
  // again when all surface of the label has been removed.
  constexpr double kStep = 1.0 / (int64_t{1} << 40);
  amount.area += sign * std::round(piece.area / kStep) * kStep;
  ++amount.version;
}

bool BlockSurfaces::Update(const BlockMesh& block, double voxel_size) {
  const auto found = blocks_.find(block.block);
  const bool had = found != blocks_.end();
  if (had) {
    for (const Piece& piece : found->second) Count(piece, -1);
    piece_bytes_ -= BytesOf(found->second);
  }
  if (block.mesh.triangles.empty()) {
    if (had) blocks_.erase(found);
    return had;
  }
  std::vector<Piece> pieces = PiecesOf(block, voxel_size);
  for (const Piece& piece : pieces) Count(piece, +1);
  piece_bytes_ += BytesOf(pieces);
  blocks_[block.block] = std::move(pieces);
  return true;
}

std::vector<BlockIndex> BlockSurfaces::Blocks() const {
  std::vector<BlockIndex> blocks;
  for (const auto& entry : blocks_) blocks.push_back(entry.first);
  return blocks;
}

BlockSurfaces::Amount BlockSurfaces::AmountOf(SegmentLabel label) const {
  return Raw(label) < amounts_.size() ? amounts_[Raw(label)] : Amount{};
}

void BlockSurfaces::AddPoints(SegmentLabel label, const BlockIndex& block, double voxel_size,
                              std::vector<Eigen::Vector3f>* points_W) const {
  const auto found = blocks_.find(block);
  if (found == blocks_.end()) return;
  const Eigen::Vector3d first_W = FirstCenter(block, voxel_size);
  for (const Piece& piece : found->second) {
    if (piece.label != label) continue;
    for (const Point& point : piece.points) {
      const Eigen::Vector3d steps = Eigen::Vector3d(point[0], point[1], point[2]).array() + 0.5;
      points_W->push_back((first_W + steps * (voxel_size / kSteps)).cast<float>());
    }
  }
}

}  // namespace vismap
