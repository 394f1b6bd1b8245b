#include "objects/islands.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "meshing/mesh_parts.h"

namespace vismap {
namespace {

constexpr double kMainBorder = 0.75;  // share of the border that one other owner must have
// Number of edges across the rim of a disc of n vertices, divided by sqrt(n). The disc has
// 3.5 sqrt(n) outer vertices with two outward edges each, and every edge is counted by two
// triangles.
constexpr double kRimOfDisc = 14;
constexpr double kFlush = 0.7;  // least dot product of the mean normals on both sides of the border
constexpr double kLeastRim = 0.5;  // least border length, as a share of the rim of such a disc

/// An instance (with bit 32 set), or a segment outside of all instances; 0 = no segment.
using Owner = uint64_t;

Owner OwnerOf(const MeshVertex& vertex) {
  if (vertex.segment == SegmentLabel::kNone) return 0;
  if (vertex.instance != InstanceId::kNone) return uint64_t{1} << 32 | Raw(vertex.instance);
  return Raw(vertex.segment);
}

struct Piece {
  Owner owner = 0;
  int64_t vertices = 0;
  double area = 0;                                    // [m^2]
  Eigen::Vector3d normals = Eigen::Vector3d::Zero();  // sum over its vertices
  Eigen::Vector3d border_normals =
      Eigen::Vector3d::Zero();  // sum over the far ends of border edges
  bool candidate = false;       // small enough to be an island
  bool has_body = true;         // whether its owner has a piece that is not a candidate
  std::map<std::pair<Owner, SegmentLabel>, int64_t> border;  // number of edges to other pieces
};

template <typename Visit>
void ForEachEdge(const Mesh& mesh, const Visit& visit) {
  for (const auto& [a, b, c] : mesh.triangles) {
    visit(a, b);
    visit(b, c);
    visit(c, a);
  }
}

class Islands {
 public:
  Islands(const MeshingOptions& options, const Mesh& mesh)
      : piece_of_(ConnectedComponents(mesh, [&](uint32_t a, uint32_t b) {
          return OwnerOf(mesh.vertices[a]) == OwnerOf(mesh.vertices[b]);
        })) {
    Measure(mesh);
    MarkCandidates(options);
    MeasureBorders(mesh);
  }

  uint32_t count() const { return static_cast<uint32_t>(pieces_.size()); }
  uint32_t PieceOf(size_t vertex) const { return piece_of_[vertex]; }

  /// The segment that surrounds a piece; kNone if the piece is not an island.
  SegmentLabel SurroundingSegment(uint32_t piece) const {
    const Piece& island = pieces_[piece];
    if (!island.candidate) return SegmentLabel::kNone;  // too large
    std::map<Owner, double> by_owner;
    double all = 0;
    for (const auto& [side, edges] : island.border) {
      by_owner[side.first] += static_cast<double>(edges);
      all += static_cast<double>(edges);
    }
    const auto most =
        std::max_element(by_owner.begin(), by_owner.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    // No border at all, or most of it is with surface that has no segment.
    if (most == by_owner.end() || most->first == 0) return SegmentLabel::kNone;
    const auto vertices = static_cast<double>(island.vertices);
    if (most->second < kMainBorder * all) return SegmentLabel::kNone;  // between several owners
    const bool enclosed = most->second >= kLeastRim * kRimOfDisc * std::sqrt(vertices);
    const bool flush = island.normals.dot(island.border_normals) >= kFlush * vertices * all;
    // It stands on the surface or ends at unobserved space.
    if (island.has_body && !(enclosed && flush)) return SegmentLabel::kNone;
    return MainSegment(island, most->first);
  }

 private:
  void Measure(const Mesh& mesh) {
    const auto last = std::max_element(piece_of_.begin(), piece_of_.end());
    pieces_.resize(last == piece_of_.end() ? 0 : *last + size_t{1});
    for (size_t i = 0; i < piece_of_.size(); ++i) {
      Piece& piece = pieces_[piece_of_[i]];
      piece.owner = OwnerOf(mesh.vertices[i]);
      ++piece.vertices;
      piece.normals += mesh.vertices[i].normal_W.cast<double>();
    }
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const double third = TriangleArea(mesh, i) / 3;
      for (const uint32_t corner : mesh.triangles[i]) pieces_[piece_of_[corner]].area += third;
    }
  }

  void MarkCandidates(const MeshingOptions& options) {
    std::map<Owner, double> areas;
    for (const Piece& piece : pieces_) areas[piece.owner] += piece.area;
    std::set<Owner> with_body;
    for (Piece& piece : pieces_) {
      piece.candidate = piece.owner != 0 && piece.area < options.island_max_area_m2 &&
                        piece.area < options.island_max_share * areas[piece.owner];
      if (!piece.candidate) with_body.insert(piece.owner);
    }
    for (Piece& piece : pieces_) piece.has_body = with_body.contains(piece.owner);
  }

  // Counts the edges from candidates to other pieces, and adds up the normals beyond the border.
  void MeasureBorders(const Mesh& mesh) {
    const auto add = [&](uint32_t from, uint32_t to) {
      Piece& piece = pieces_[piece_of_[from]];
      if (!piece.candidate) return;
      ++piece.border[{OwnerOf(mesh.vertices[to]), mesh.vertices[to].segment}];
      piece.border_normals += mesh.vertices[to].normal_W.cast<double>();
    };
    ForEachEdge(mesh, [&](uint32_t a, uint32_t b) {
      if (piece_of_[a] == piece_of_[b]) return;
      add(a, b);
      add(b, a);
    });
  }

  // The segment of `owner` that most edges across the border lead to; ties to the lower label.
  static SegmentLabel MainSegment(const Piece& piece, Owner owner) {
    SegmentLabel main = SegmentLabel::kNone;
    int64_t most = 0;
    for (const auto& [side, edges] : piece.border) {
      if (side.first != owner || edges <= most) continue;
      main = side.second;
      most = edges;
    }
    return main;
  }

  std::vector<uint32_t> piece_of_;  // by vertex
  std::vector<Piece> pieces_;
};

}  // namespace

void AbsorbIslands(const MeshingOptions& options, Mesh* mesh) {
  const Islands islands(options, *mesh);
  std::vector<SegmentLabel> around(islands.count());
  for (uint32_t piece = 0; piece < islands.count(); ++piece)
    around[piece] = islands.SurroundingSegment(piece);
  for (size_t i = 0; i < mesh->vertices.size(); ++i) {
    const SegmentLabel segment = around[islands.PieceOf(i)];
    if (segment != SegmentLabel::kNone) mesh->vertices[i].segment = segment;
  }
}

}  // namespace vismap
