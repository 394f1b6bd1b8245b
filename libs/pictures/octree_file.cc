#include "pictures/octree_file.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/printable.h"
#include "freespace/octree_cube.h"
#include "navigation/tree_leaves.h"

namespace vismap {
namespace {

constexpr std::string_view kFullTree = "# Octomap OcTree file";
constexpr size_t kMostHeaderBytes = 4096;

struct TreeHeader {
  bool colored = false;
  double resolution = 0;  // [m]
  uint64_t nodes = 0;     // inner nodes and leaves
  size_t bytes = 0;       // up to the first node
};

// The word behind `key` at the start of a line; "" when there is none.
std::string_view WordAfter(std::string_view text, std::string_view key) {
  for (size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    if (at > 0 && text[at - 1] != '\n') continue;
    const std::string_view rest = text.substr(at + key.size());
    return rest.substr(0, rest.find('\n'));
  }
  return {};
}

template <typename Number>
bool ReadNumber(std::string_view word, Number* number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), *number);
  return error == std::errc() && end == word.data() + word.size();
}

Result<TreeHeader> ReadTreeHeader(std::span<const uint8_t> bytes, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min(bytes.size(), kMostHeaderBytes));
  const size_t end = text.find("\ndata\n");
  if (end == std::string_view::npos)
    return Fail(name + ": expected the line 'data' in the first 4096 bytes of an octree");
  const std::string_view head = text.substr(0, end + 1);
  TreeHeader header;
  header.bytes = end + std::strlen("\ndata\n");
  const std::string_view kind = WordAfter(head, "id ");
  header.colored = kind == "ColorOcTree";
  if (!header.colored && kind != "OcTree") {
    return Fail(name + ": expected an octree of the kind OcTree or ColorOcTree, found '" +
                PrintableText(kind, 60) + "'");
  }
  if (!ReadNumber(WordAfter(head, "res "), &header.resolution) ||
      !(header.resolution > 1e-6 && header.resolution < 1e6))
    return Fail(name + ": expected a line 'res METRES'");
  if (!ReadNumber(WordAfter(head, "size "), &header.nodes))
    return Fail(name + ": expected a line 'size NODES'");
  return header;
}

// Reads the nodes of an `.ot` file: log odds (f32), colour (3 bytes, of a ColorOcTree) and a byte
// with a bit for each child, then the children.
class FullTreeReader {
 public:
  FullTreeReader(std::span<const uint8_t> nodes, const TreeHeader& header, OctreeLeaves* leaves)
      : nodes_(nodes), header_(header), leaves_(leaves) {}

  /// Returns what is wrong; "" = nothing.
  std::string Read() {
    if (header_.nodes > 0) Visit(OctreeCube::Everything());
    if (problem_.empty() && at_ != nodes_.size())
      problem_ = std::to_string(nodes_.size() - at_) + " bytes are left over";
    if (problem_.empty() && count_ != header_.nodes)
      problem_ =
          "expected " + std::to_string(header_.nodes) + " nodes, found " + std::to_string(count_);
    return problem_;
  }

 private:
  void Visit(const OctreeCube& cube) {
    const size_t size = header_.colored ? 8 : 5;
    if (nodes_.size() - at_ < size) return Stop("the file ends within a node");
    float odds = 0;
    std::memcpy(&odds, &nodes_[at_], sizeof odds);
    const Rgb8 color =
        header_.colored ? Rgb8{nodes_[at_ + 4], nodes_[at_ + 5], nodes_[at_ + 6]} : Rgb8{};
    const uint8_t children = nodes_[at_ + size - 1];
    at_ += size;
    ++count_;
    if (!std::isfinite(odds)) return Stop("the log odds of a node are not finite");
    if (children == 0) return Fill(cube, odds >= 0, color);
    if (cube.size == 1) return Stop("a node of the smallest size has children");
    if (cube.size == kBlockSide) BeginBlock();
    for (int child = 0; child < 8 && problem_.empty(); ++child)
      if ((children >> child & 1) != 0) Visit(cube.Child(child));
    if (cube.size == kBlockSide && problem_.empty()) EndBlock(BlockOf(cube.min));
  }

  void Stop(std::string problem) { problem_ = std::move(problem); }

  void BeginBlock() {
    planes_ = {};
    colors_ = {};
  }

  void EndBlock(BlockIndex index) {
    if (!CountBlock()) return;
    leaves_->cells.Set(index, BlockOccupancy(planes_));
    if (planes_.occupied != decltype(planes_.occupied){}) SetColors(index);
  }

  void SetColors(BlockIndex index) {
    if (!leaves_->colors) return;
    if (++colored_ > kMostColoredBlocks)
      return Stop("the occupied leaves cover more than " + std::to_string(kMostColoredBlocks) +
                  " blocks of 8x8x8 leaves");
    (*leaves_->colors)[index] = colors_;
  }

  bool CountBlock() {
    if (++blocks_ <= kMostTreeBlocks) return true;
    Stop("the tree covers more than " + std::to_string(kMostTreeBlocks) +
         " blocks of 8x8x8 leaves");
    return false;
  }

  void Fill(const OctreeCube& cube, bool occupied, Rgb8 color) {
    if (cube.size >= kBlockSide) return FillBlocks(cube, occupied, color);
    ForEachOffset(cube, [&](size_t offset) {
      (occupied ? planes_.occupied : planes_.free)[offset / 64] |= uint64_t{1} << (offset % 64);
      colors_[offset] = color;
    });
  }

  void FillBlocks(const OctreeCube& cube, bool occupied, Rgb8 color) {
    const BlockOccupancy block(occupied ? CellState::kOccupied : CellState::kFree);
    colors_.fill(color);
    ForEachBlock(cube, [&](BlockIndex index) {
      if (!CountBlock()) return false;
      leaves_->cells.Set(index, block);
      if (occupied) SetColors(index);
      return problem_.empty();
    });
  }

  std::span<const uint8_t> nodes_;
  const TreeHeader& header_;
  OctreeLeaves* leaves_;
  size_t at_ = 0;
  uint64_t count_ = 0;
  int64_t blocks_ = 0, colored_ = 0;
  OccupancyPlanes planes_;  // of the block that is being read
  BlockColors colors_{};
  std::string problem_;
};

}  // namespace

Result<OctreeLeaves> ReadOctree(std::span<const uint8_t> bytes, const std::string& name) {
  OctreeLeaves leaves;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kFullTree)) {
    Result<OccupancyMap> cells = ReadTreeLeaves(bytes, name);
    if (!cells) return tl::unexpected(cells.error());
    leaves.cells = std::move(*cells);
    return leaves;
  }
  const Result<TreeHeader> header = ReadTreeHeader(bytes, name);
  if (!header) return tl::unexpected(header.error());
  leaves.cells = OccupancyMap(header->resolution);
  if (header->colored) leaves.colors.emplace();
  const std::string problem = FullTreeReader(bytes.subspan(header->bytes), *header, &leaves).Read();
  if (!problem.empty()) return Fail(name + ": " + problem);
  return leaves;
}

}  // namespace vismap
