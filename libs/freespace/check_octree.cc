#include <cmath>
#include <limits>
#include <sstream>
#include <string_view>

#include "freespace/octree.h"

namespace vismap {
namespace {

constexpr int kTreeDepth = 16;

struct Header {
  int64_t nodes = 0;
  double resolution = 0;
  size_t data_begin = 0;
};

/// The number behind the key of a header line such as "size 12"; NaN when there is no number.
double NumberAfter(std::string_view line, size_t start) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::istringstream text{std::string(line.substr(start))};
  text.imbue(std::locale::classic());
  double value = kNone;
  std::string rest;
  if (!(text >> value) || text >> rest) return kNone;
  return value;
}

/// Reads one line between the first line and "data".
Result<void> ParseHeaderLine(std::string_view line, Header* header, bool* has_id) {
  if (line.empty() || line.front() == '#') return {};
  if (line.starts_with("id ")) {
    if (line != "id OcTree") return Fail("expected 'id OcTree', found '" + std::string(line) + "'");
    *has_id = true;
  } else if (line.starts_with("size ")) {
    const double nodes = NumberAfter(line, 5);
    if (!(nodes >= 0 && nodes < 1e12)) return Fail("the header's size is not a count");
    header->nodes = static_cast<int64_t>(nodes);
  } else if (line.starts_with("res ")) {
    header->resolution = NumberAfter(line, 4);
  } else {
    return Fail("unknown header line '" + std::string(line.substr(0, 40)) + "'");
  }
  return {};
}

Result<Header> ParseHeader(std::string_view text) {
  constexpr size_t kMaxHeader = 4096;
  constexpr std::string_view kFirstLine = "# Octomap OcTree binary file";
  Header header;
  bool has_id = false;
  size_t line_begin = 0;
  for (int number = 1;; ++number) {
    const size_t line_end = text.substr(0, kMaxHeader).find('\n', line_begin);
    if (line_end == std::string_view::npos) return Fail("expected a header that ends in 'data'");
    const std::string_view line = text.substr(line_begin, line_end - line_begin);
    line_begin = line_end + 1;
    if (number == 1) {
      if (line == kFirstLine) continue;
      return Fail("expected '" + std::string(kFirstLine) + "' in the first line");
    }
    if (line == "data") break;
    if (Result<void> parsed = ParseHeaderLine(line, &header, &has_id); !parsed)
      return tl::unexpected(parsed.error());
  }
  if (!has_id) return Fail("the header has no 'id OcTree'");
  if (!(header.resolution > 0 && header.resolution < 1e4)) {
    return Fail("the header's res is not a positive length");
  }
  header.data_begin = line_begin;
  return header;
}

/// Walks the nodes without building a tree. OctoMap itself checks neither the depth nor the end of
/// the data.
class NodeWalk {
 public:
  explicit NodeWalk(std::span<const uint8_t> data) : data_(data) {}

  /// False when the data end early, go deeper than OctoMap's trees, or hold an inner node without
  /// children.
  bool Visit(int depth) {
    if (depth >= kTreeDepth || data_.size() - at_ < 2) return false;
    const uint32_t code = data_[at_] | static_cast<uint32_t>(data_[at_ + 1]) << 8;
    at_ += 2;
    if (code == 0) return false;
    for (int child = 0; child < 8; ++child) {
      const uint32_t state = (code >> (2 * child)) & 3;
      nodes_ += state != 0;
      if (state == 3 && !Visit(depth + 1)) return false;
    }
    return true;
  }

  size_t consumed() const { return at_; }
  int64_t nodes() const { return nodes_; }  ///< without the root

 private:
  std::span<const uint8_t> data_;
  size_t at_ = 0;
  int64_t nodes_ = 0;
};

Result<void> CheckNodes(const Header& header, std::span<const uint8_t> data) {
  NodeWalk walk(data);
  int64_t nodes = 0;
  if (!data.empty() || header.nodes > 0) {
    if (!walk.Visit(0)) {
      return Fail("the nodes are damaged or cut at byte " + std::to_string(walk.consumed()) +
                  " of " + std::to_string(data.size()));
    }
    nodes = walk.nodes() + 1;
  }
  if (walk.consumed() != data.size()) {
    return Fail(std::to_string(data.size() - walk.consumed()) + " bytes are left after the tree");
  }
  if (nodes != header.nodes) {
    return Fail("the header promises " + std::to_string(header.nodes) + " nodes, found " +
                std::to_string(nodes));
  }
  return {};
}

}  // namespace

Result<OctreeStreamInfo> CheckOctree(std::span<const uint8_t> bytes, const std::string& name) {
  const Result<Header> header =
      ParseHeader({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!header) return Fail(name + ": " + header.error().message);
  const Result<void> checked = CheckNodes(*header, bytes.subspan(header->data_begin));
  if (!checked) return Fail(name + ": " + checked.error().message);
  return OctreeStreamInfo{header->resolution, header->nodes};
}

}  // namespace vismap
