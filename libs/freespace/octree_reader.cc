#include <octomap/octomap.h>

#include <cmath>
#include <cstring>
#include <iomanip>
#include <sstream>
#include <string_view>

#include "base/file.h"
#include "freespace/octree.h"

namespace vismap {
namespace {

constexpr int kTreeDepth = 16;

struct Header {
  bool binary = false;  ///< .bt, else .ot
  int64_t nodes = 0;
  double resolution = 0;
  size_t data_begin = 0;
};

/// Number of a header line such as "size 12"; NaN when it is none.
double NumberAfter(std::string_view line, size_t start) {
  std::istringstream text{std::string(line.substr(start))};
  text.imbue(std::locale::classic());
  double value = std::nan("");
  std::string rest;
  if (!(text >> value) || text >> rest) return std::nan("");
  return value;
}

Result<Header> ParseHeader(std::string_view text) {
  constexpr size_t kMaxHeader = 4096;
  Header header;
  bool has_id = false;
  size_t line_begin = 0;
  for (int number = 1;; ++number) {
    const size_t line_end = text.substr(0, kMaxHeader).find('\n', line_begin);
    if (line_end == std::string_view::npos) return Fail("expected a header that ends in 'data'");
    const std::string_view line = text.substr(line_begin, line_end - line_begin);
    line_begin = line_end + 1;
    if (number == 1) {
      header.binary = line == "# Octomap OcTree binary file";
      if (header.binary || line == "# Octomap OcTree file") continue;
      return Fail("expected '# Octomap OcTree [binary ]file' in the first line");
    }
    if (line.empty() || line.front() == '#') continue;
    if (line == "data") break;
    if (line.starts_with("id ")) {
      if (line != "id OcTree")
        return Fail("expected 'id OcTree', found '" + std::string(line) + "'");
      has_id = true;
    } else if (line.starts_with("size ")) {
      const double nodes = NumberAfter(line, 5);
      if (!(nodes >= 0 && nodes < 1e12)) return Fail("the header's size is not a count");
      header.nodes = static_cast<int64_t>(nodes);
    } else if (line.starts_with("res ")) {
      header.resolution = NumberAfter(line, 4);
    } else {
      return Fail("unknown header line '" + std::string(line.substr(0, 40)) + "'");
    }
  }
  if (!has_id) return Fail("the header has no 'id OcTree'");
  if (!(header.resolution > 0 && header.resolution < 1e4)) {
    return Fail("the header's res is not a positive length");
  }
  header.data_begin = line_begin;
  return header;
}

/// Walks the nodes without building anything. OctoMap itself checks neither depth nor end.
class Walker {
 public:
  explicit Walker(std::span<const uint8_t> data) : data_(data) {}

  /// False when the data end early, go too deep, or hold an inner node without children.
  bool WalkBinary(int depth) {
    if (depth >= kTreeDepth || data_.size() - at_ < 2) return false;
    const uint32_t code = data_[at_] | static_cast<uint32_t>(data_[at_ + 1]) << 8;
    at_ += 2;
    if (code == 0) return false;
    for (int child = 0; child < 8; ++child) {
      const uint32_t state = (code >> (2 * child)) & 3;
      nodes_ += state != 0;
      if (state == 3 && !WalkBinary(depth + 1)) return false;
    }
    return true;
  }

  bool WalkFull(int depth) {
    if (depth > kTreeDepth || data_.size() - at_ < 5) return false;
    float value = 0;
    std::memcpy(&value, &data_[at_], sizeof(value));
    const uint32_t children = data_[at_ + 4];
    at_ += 5;
    ++nodes_;
    if (!std::isfinite(value) || (depth == kTreeDepth && children != 0)) return false;
    for (int child = 0; child < 8; ++child) {
      if (((children >> child) & 1) && !WalkFull(depth + 1)) return false;
    }
    return true;
  }

  size_t consumed() const { return at_; }
  int64_t nodes() const { return nodes_; }

 private:
  std::span<const uint8_t> data_;
  size_t at_ = 0;
  int64_t nodes_ = 0;
};

Result<void> CheckData(const Header& header, std::span<const uint8_t> data) {
  Walker walker(data);
  int64_t nodes = 0;
  if (!data.empty() || header.nodes > 0) {
    const bool whole = header.binary ? walker.WalkBinary(0) : walker.WalkFull(0);
    if (!whole) {
      return Fail("the nodes are damaged or cut at byte " + std::to_string(walker.consumed()) +
                  " of " + std::to_string(data.size()));
    }
    nodes = walker.nodes() + (header.binary ? 1 : 0);
  }
  if (walker.consumed() != data.size()) {
    return Fail(std::to_string(data.size() - walker.consumed()) + " bytes are left after the tree");
  }
  if (nodes != header.nodes) {
    return Fail("the header promises " + std::to_string(header.nodes) + " nodes, found " +
                std::to_string(nodes));
  }
  return {};
}

std::string_view TextOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The header of a stream of which every byte is right.
Result<Header> CheckStream(std::span<const uint8_t> bytes) {
  const Result<Header> header = ParseHeader(TextOf(bytes));
  if (!header) return header;
  const Result<void> checked = CheckData(*header, bytes.subspan(header->data_begin));
  if (!checked) return tl::unexpected(checked.error());
  return header;
}

}  // namespace

struct Octree::Impl {
  explicit Impl(double resolution) : tree(resolution) {}
  octomap::OcTree tree;
};

Octree::Octree(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Octree::Octree(Octree&&) noexcept = default;
Octree& Octree::operator=(Octree&&) noexcept = default;
Octree::~Octree() = default;

Result<OctreeStreamInfo> CheckOctree(std::span<const uint8_t> bytes, const std::string& name) {
  const Result<Header> header = CheckStream(bytes);
  if (!header) return Fail(name + ": " + header.error().message);
  return OctreeStreamInfo{header->resolution, header->nodes};
}

Result<Octree> Octree::Parse(std::span<const uint8_t> bytes, const std::string& name) {
  const Result<Header> header = CheckStream(bytes);
  if (!header) return Fail(name + ": " + header.error().message);
  auto impl = std::make_unique<Impl>(header->resolution);
  if (header->nodes > 0) {
    std::istringstream data{std::string(TextOf(bytes).substr(header->data_begin))};
    if (header->binary) {
      impl->tree.readBinaryData(data);
    } else {
      impl->tree.readData(data);
    }
  }
  if (static_cast<int64_t>(impl->tree.size()) != header->nodes) {
    return Fail(name + ": OctoMap read " + std::to_string(impl->tree.size()) + " nodes, expected " +
                std::to_string(header->nodes));
  }
  return Octree(std::move(impl));
}

Result<Octree> ReadOctree(const std::filesystem::path& path) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return Octree::Parse(*bytes, path.string());
}

double Octree::resolution() const { return impl_->tree.getResolution(); }

int64_t Octree::nodes() const { return static_cast<int64_t>(impl_->tree.size()); }

CellState Octree::At(const Eigen::Vector3d& p_W) const {
  const octomap::OcTreeNode* node = impl_->tree.search(p_W.x(), p_W.y(), p_W.z());
  if (node == nullptr) return CellState::kUnknown;
  return impl_->tree.isNodeOccupied(node) ? CellState::kOccupied : CellState::kFree;
}

std::vector<Octree::Leaf> Octree::Leaves() const {
  std::vector<Leaf> leaves;
  for (auto it = impl_->tree.begin_leafs(); it != impl_->tree.end_leafs(); ++it) {
    const double size = it.getSize();
    const Eigen::Vector3d center(it.getX(), it.getY(), it.getZ());
    const CellState state =
        impl_->tree.isNodeOccupied(*it) ? CellState::kOccupied : CellState::kFree;
    leaves.push_back({center - Eigen::Vector3d::Constant(size / 2), size, state});
  }
  return leaves;
}

Result<std::vector<uint8_t>> ConvertToOt(const OctreeBytes& octree) {
  Result<Octree> tree = Octree::Parse(octree.bytes, "octree");
  if (!tree) return tl::unexpected(tree.error());
  return tree->EncodeOt();
}

std::vector<uint8_t> Octree::EncodeOt() const {
  std::ostringstream full;
  full.imbue(std::locale::classic());
  full << "# Octomap OcTree file\n"
       << "# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
       << "id OcTree\nsize " << nodes() << "\nres " << std::setprecision(12) << resolution()
       << "\ndata\n";
  impl_->tree.writeData(full);
  const std::string bytes = full.str();
  return {bytes.begin(), bytes.end()};
}

}  // namespace vismap
