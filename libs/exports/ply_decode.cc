#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>

#include "exports/ply.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers of PLY files are little-endian and are copied without conversion");

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

std::optional<NumberType> ParseType(const std::string& word) {
  static const std::map<std::string, NumberType> kTypes = {
      {"char", NumberType::kInt8},     {"int8", NumberType::kInt8},
      {"uchar", NumberType::kUint8},   {"uint8", NumberType::kUint8},
      {"short", NumberType::kInt16},   {"int16", NumberType::kInt16},
      {"ushort", NumberType::kUint16}, {"uint16", NumberType::kUint16},
      {"int", NumberType::kInt32},     {"int32", NumberType::kInt32},
      {"uint", NumberType::kUint32},   {"uint32", NumberType::kUint32},
      {"float", NumberType::kFloat},   {"float32", NumberType::kFloat},
      {"double", NumberType::kDouble}, {"float64", NumberType::kDouble}};
  const auto found = kTypes.find(word);
  if (found == kTypes.end()) return std::nullopt;
  return found->second;
}

size_t SizeOf(NumberType type) {
  switch (type) {
    case NumberType::kInt8:
    case NumberType::kUint8:
      return 1;
    case NumberType::kInt16:
    case NumberType::kUint16:
      return 2;
    case NumberType::kDouble:
      return 8;
    default:
      return 4;
  }
}

template <typename T>
double As(const uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return static_cast<double>(value);
}

double ReadNumber(NumberType type, const uint8_t* at) {
  switch (type) {
    case NumberType::kInt8:
      return As<int8_t>(at);
    case NumberType::kUint8:
      return As<uint8_t>(at);
    case NumberType::kInt16:
      return As<int16_t>(at);
    case NumberType::kUint16:
      return As<uint16_t>(at);
    case NumberType::kInt32:
      return As<int32_t>(at);
    case NumberType::kUint32:
      return As<uint32_t>(at);
    case NumberType::kFloat:
      return As<float>(at);
    case NumberType::kDouble:
      return As<double>(at);
  }
  return 0;
}

struct Property {
  std::string name;
  NumberType type = NumberType::kFloat;
  std::optional<NumberType> count_type{};  ///< set = the property is a list
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties{};
};

constexpr int kMaxHeaderLines = 100'000;  // there may be a comment for each class

struct PlyHeader {
  std::vector<Element> elements;
  PlyInfo info;
  size_t size = 0;  ///< [bytes], with the last line break
};

void ParseComment(std::istringstream& words, PlyInfo* info) {
  std::string key;
  words >> key >> std::ws;
  if (key == "map_id") {
    std::getline(words, info->map_id);
  } else if (key == "class") {
    uint16_t id = 0;
    std::string name;
    if (words >> id >> std::ws && std::getline(words, name)) info->class_names[ClassId{id}] = name;
  }
}

std::optional<Property> ParseProperty(std::istringstream& words) {
  Property property;
  std::string word;
  words >> word;
  if (word == "list") {
    std::string count_word;
    words >> count_word >> word;
    property.count_type = ParseType(count_word);
    if (!property.count_type) return std::nullopt;
  }
  const auto type = ParseType(word);
  if (!type || !(words >> property.name)) return std::nullopt;
  property.type = *type;
  return property;
}

// Two elements of one name are refused: faces would refer to vertices that the second one replaces.
bool HasElement(const PlyHeader& header, const std::string& name) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [&](const Element& element) { return element.name == name; });
}

// Parses one line of the header. Returns false if it is not valid.
bool ParseLine(const std::string& line, PlyHeader* header) {
  std::istringstream words(line);
  std::string key;
  words >> key;
  if (key == "comment" || key == "obj_info" || key.empty()) {
    ParseComment(words, &header->info);
    return true;
  }
  if (key == "format") {
    std::string format;
    return words >> format && format == "binary_little_endian";
  }
  if (key == "element") {
    Element element;
    if (!(words >> element.name >> element.count)) return false;
    if (HasElement(*header, element.name)) return false;
    header->elements.push_back(element);
    return true;
  }
  if (key != "property" || header->elements.empty()) return false;
  const auto property = ParseProperty(words);
  if (property) header->elements.back().properties.push_back(*property);
  return property.has_value();
}

Result<PlyHeader> ParseHeader(std::span<const uint8_t> bytes, const std::string& name) {
  PlyHeader header;
  for (int number = 1; header.size < bytes.size(); ++number) {
    if (number > kMaxHeaderLines)
      return Fail(name + ": expected a PLY header of at most " + std::to_string(kMaxHeaderLines) +
                  " lines");
    std::string line;
    while (header.size < bytes.size() && bytes[header.size] != '\n') {
      line.push_back(static_cast<char>(bytes[header.size++]));
      if (line.size() > 4096)
        return Fail(name + ": expected a PLY header, found a line of more than 4096 characters");
    }
    ++header.size;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line != "ply")
        return Fail(name + ": expected a PLY file, but the first line is not 'ply'");
      continue;
    }
    if (line == "end_header") {
      if (header.size > bytes.size()) break;
      return header;
    }
    if (!ParseLine(line, &header)) {
      return Fail(name + ": line " + std::to_string(number) +
                  ": expected a header line of a binary little-endian PLY, found '" + line + "'");
    }
  }
  return Fail(name + ": the file ends inside its header");
}

// Reads the numbers of the body one after the other. Read returns false at its end.
class Cursor {
 public:
  explicit Cursor(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool Read(NumberType type, double* value) {
    if (bytes_.size() < SizeOf(type)) return false;
    *value = ReadNumber(type, bytes_.data());
    bytes_ = bytes_.subspan(SizeOf(type));
    return true;
  }
  size_t left() const { return bytes_.size(); }

 private:
  std::span<const uint8_t> bytes_;
};

// The values of one vertex or face: a list of numbers per property. A property that is not a list
// has one number.
using Record = std::vector<std::vector<double>>;

// Returns false if the file ends within the record.
bool ReadRecord(const Element& element, Cursor* cursor, Record* record) {
  record->resize(element.properties.size());
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const Property& property = element.properties[i];
    double count = 1;
    if (property.count_type && !cursor->Read(*property.count_type, &count)) return false;
    if (!(count >= 0) ||
        count * static_cast<double>(SizeOf(property.type)) > static_cast<double>(cursor->left())) {
      return false;
    }
    (*record)[i].resize(static_cast<size_t>(count));
    for (double& value : (*record)[i]) {
      if (!cursor->Read(property.type, &value)) return false;
    }
  }
  return true;
}

// The smallest possible size of one record [bytes]. It is used to refuse counts that the file
// cannot hold, before memory is allocated for them.
uint64_t MinimumSize(const Element& element) {
  uint64_t size = 0;
  for (const Property& property : element.properties) {
    size += SizeOf(property.count_type.value_or(property.type));
  }
  return size;
}

constexpr size_t kMissing = std::numeric_limits<size_t>::max();

// Index of the property with this name, or kMissing. `list` = whether it must be a list.
size_t Find(const Element& element, const char* name, bool list = false) {
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const Property& property = element.properties[i];
    if (property.name == name && property.count_type.has_value() == list) return i;
  }
  return kMissing;
}

// Converts a number of any type to an id. Returns false if it is not a whole number in range. A
// missing column leaves the id as it is.
template <typename Id>
bool ToId(const Record& record, size_t column, Id* id) {
  if (column == kMissing) return true;
  const double value = record[column][0];
  using Number = std::underlying_type_t<Id>;
  if (!(value >= 0) || value > static_cast<double>(std::numeric_limits<Number>::max()) ||
      value != std::floor(value)) {
    return false;
  }
  *id = static_cast<Id>(static_cast<Number>(value));
  return true;
}

uint8_t ToByte(const Record& record, size_t column) {
  const double value = column == kMissing ? 0 : record[column][0];
  return value >= 0 && value <= 255 ? static_cast<uint8_t>(value) : 0;
}

// The index of each property of a vertex that is used; kMissing = the file does not have it.
struct VertexColumns {
  std::array<size_t, 3> position, normal, color;
  size_t segment, instance, class_id;

  explicit VertexColumns(const Element& e)
      : position{Find(e, "x"), Find(e, "y"), Find(e, "z")},
        normal{Find(e, "nx"), Find(e, "ny"), Find(e, "nz")},
        color{Find(e, "red"), Find(e, "green"), Find(e, "blue")},
        segment(Find(e, "segment")),
        instance(Find(e, "instance")),
        class_id(Find(e, "class")) {
    if (segment == kMissing) segment = Find(e, "label");
  }
};

Eigen::Vector3f ToVector(const Record& record, const std::array<size_t, 3>& columns) {
  Eigen::Vector3f vector = Eigen::Vector3f::Zero();
  for (size_t i = 0; i < 3; ++i) {
    if (columns[i] != kMissing) {
      vector[static_cast<int>(i)] = static_cast<float>(record[columns[i]][0]);
    }
  }
  return vector;
}

bool ToVertex(const Record& record, const VertexColumns& columns, MeshVertex* vertex) {
  vertex->position_W = ToVector(record, columns.position);
  vertex->normal_W = ToVector(record, columns.normal);
  vertex->color = {ToByte(record, columns.color[0]), ToByte(record, columns.color[1]),
                   ToByte(record, columns.color[2])};
  return ToId(record, columns.segment, &vertex->segment) &&
         ToId(record, columns.instance, &vertex->instance) &&
         ToId(record, columns.class_id, &vertex->class_id);
}

Result<void> ReadVertices(const Element& element, const std::string& name, Cursor* cursor,
                          Mesh* mesh) {
  const VertexColumns columns(element);
  for (const size_t column : columns.position) {
    if (column == kMissing)
      return Fail(name +
                  ": expected the vertex properties x, y and z, but not all of them are there");
  }
  mesh->vertices.resize(element.count);
  Record record;
  for (uint64_t i = 0; i < element.count; ++i) {
    if (!ReadRecord(element, cursor, &record)) {
      return Fail(name + ": the file ends inside vertex " + std::to_string(i) + " of " +
                  std::to_string(element.count));
    }
    if (!ToVertex(record, columns, &mesh->vertices[i])) {
      return Fail(name + ": vertex " + std::to_string(i) +
                  ": expected segment, instance and class to be whole numbers in range");
    }
  }
  return {};
}

// Appends a polygon as a fan of triangles. Returns false if an index is out of range.
bool AppendPolygon(const std::vector<double>& corners, Mesh* mesh) {
  std::vector<uint32_t> indices;
  for (const double corner : corners) {
    if (!(corner >= 0) || corner >= static_cast<double>(mesh->vertices.size())) return false;
    indices.push_back(static_cast<uint32_t>(corner));
  }
  for (size_t i = 2; i < indices.size(); ++i) {
    mesh->triangles.push_back({indices[0], indices[i - 1], indices[i]});
  }
  return true;
}

Result<void> ReadFaces(const Element& element, const std::string& name, uint64_t most_triangles,
                       Cursor* cursor, Mesh* mesh) {
  size_t column = Find(element, "vertex_indices", true);
  if (column == kMissing) column = Find(element, "vertex_index", true);
  if (column == kMissing)
    return Fail(name + ": expected the face property list vertex_indices, but it is not there");
  Record record;
  for (uint64_t i = 0; i < element.count; ++i) {
    if (!ReadRecord(element, cursor, &record)) {
      return Fail(name + ": the file ends inside face " + std::to_string(i) + " of " +
                  std::to_string(element.count));
    }
    if (!AppendPolygon(record[column], mesh)) {
      return Fail(name + ": face " + std::to_string(i) + ": expected vertex indices below " +
                  std::to_string(mesh->vertices.size()) + ", found one out of range");
    }
    if (mesh->triangles.size() > most_triangles) {
      return Fail(name + ": expected at most " + std::to_string(most_triangles) +
                  " triangles, found more");
    }
  }
  return {};
}

Result<void> SkipElement(const Element& element, const std::string& name, Cursor* cursor) {
  if (element.properties.empty()) return {};
  Record record;
  for (uint64_t i = 0; i < element.count; ++i) {
    if (!ReadRecord(element, cursor, &record)) {
      return Fail(name + ": the file ends inside the element '" + element.name + "'");
    }
  }
  return {};
}

Result<void> ReadElement(const Element& element, const std::string& name, const PlyLimits& limits,
                         Cursor* cursor, Mesh* mesh) {
  const uint64_t smallest = MinimumSize(element);
  // The file is too short for so many entries.
  if (smallest > 0 && element.count > cursor->left() / smallest) {
    return Fail(name + ": expected " + std::to_string(element.count) + " entries of element '" +
                element.name + "', found only " + std::to_string(cursor->left()) + " bytes");
  }
  if (element.name == "vertex") {
    if (element.count > limits.vertices) {
      return Fail(name + ": expected at most " + std::to_string(limits.vertices) +
                  " vertices, found " + std::to_string(element.count));
    }
    return ReadVertices(element, name, cursor, mesh);
  }
  if (element.name == "face" && element.count > 0)
    return ReadFaces(element, name, limits.triangles, cursor, mesh);
  return SkipElement(element, name, cursor);
}

}  // namespace

Result<PlyFile> DecodePly(std::span<const uint8_t> bytes, const std::string& name,
                          const PlyLimits& limits) {
  const auto header = ParseHeader(bytes, name);
  if (!header) return tl::unexpected(header.error());
  PlyFile file;
  file.info = header->info;
  Cursor cursor(bytes.subspan(header->size));
  for (const Element& element : header->elements) {
    const auto read = ReadElement(element, name, limits, &cursor, &file.mesh);
    if (!read) return tl::unexpected(read.error());
  }
  return file;
}

}  // namespace vismap
