#include "exports/ply.h"

#include <bit>
#include <cstring>
#include <sstream>

#include "base/file.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers of PLY files are little-endian and are copied without conversion");

template <typename T>
void Append(T value, std::vector<uint8_t>* bytes) {
  const size_t at = bytes->size();
  bytes->resize(at + sizeof(T));
  std::memcpy(bytes->data() + at, &value, sizeof(T));
}

std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

constexpr const char* kFirstLine = "ply";
constexpr const char* kLabelLine = "property uint segment";

std::string Header(const Mesh& mesh, const PlyInfo& info) {
  std::ostringstream header;
  header << kFirstLine << "\nformat binary_little_endian 1.0\n";
  if (!info.map_id.empty()) header << "comment map_id " << OneLine(info.map_id) << '\n';
  for (const auto& [class_id, name] : info.class_names) {
    header << "comment class " << Raw(class_id) << ' ' << OneLine(name) << '\n';
  }
  header << "element vertex " << mesh.vertices.size() << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) {
    header << "property float " << name << '\n';
  }
  for (const char* name : {"red", "green", "blue"}) header << "property uchar " << name << '\n';
  header << kLabelLine << "\nproperty uint instance\nproperty ushort class\n"
         << "element face " << mesh.triangles.size() << '\n'
         << "property list uchar int vertex_indices\nend_header\n";
  return header.str();
}

void AppendVertex(const MeshVertex& vertex, std::vector<uint8_t>* bytes) {
  for (int i = 0; i < 3; ++i) Append(vertex.position_W[i], bytes);
  for (int i = 0; i < 3; ++i) Append(vertex.normal_W[i], bytes);
  for (const uint8_t c : {vertex.color.r, vertex.color.g, vertex.color.b}) Append(c, bytes);
  Append(Raw(vertex.segment), bytes);
  Append(Raw(vertex.instance), bytes);
  Append(Raw(vertex.class_id), bytes);
}

}  // namespace

std::vector<uint8_t> EncodePly(const Mesh& mesh, const PlyInfo& info) {
  const std::string header = Header(mesh, info);
  std::vector<uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + mesh.vertices.size() * 37 + mesh.triangles.size() * 13);
  for (const MeshVertex& vertex : mesh.vertices) AppendVertex(vertex, &bytes);
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const uint32_t index : triangle) Append(index, &bytes);
  }
  return bytes;
}

Result<void> WritePly(const std::filesystem::path& path, const Mesh& mesh, const PlyInfo& info) {
  return WriteFileAtomically(path, EncodePly(mesh, info));
}

bool StartsLikeOurPly(std::istream& file) {
  std::string line;
  if (!std::getline(file, line) || line != kFirstLine) return false;
  constexpr int kMostLines = 70000;  // a comment for each class, and some more
  for (int i = 0; i < kMostLines && std::getline(file, line) && line != "end_header"; ++i) {
    if (line == kLabelLine) return true;
  }
  return false;
}

Result<PlyFile> ReadPly(const std::filesystem::path& path) {
  constexpr uint64_t kMaxPlyBytes = uint64_t{1} << 31;
  const auto bytes = ReadFileBytes(path, kMaxPlyBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return DecodePly(*bytes, path.string());
}

}  // namespace vismap
