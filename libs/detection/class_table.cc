#include "detection/class_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "base/byte_order_mark.h"
#include "base/class_names.h"
#include "base/file.h"

namespace vismap {
namespace {

// Ids of COCO's list of 91 classes for which there are no annotations: street sign, hat, shoe, eye
// glasses, plate, mirror, window, desk, door, blender, hair brush.
constexpr std::array kNotAnnotated = {12, 26, 29, 30, 45, 66, 68, 69, 71, 83, 91};

std::string Trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos
             ? ""
             : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

Result<ClassId> ParseLine(const std::string& line) {
  if (line == "-") return ClassId::kUnknown;
  if (const auto known = ClassFromName(line)) return *known;
  int id = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), id);
  const bool named = end != line.data() + line.size() && *end == ' ';
  if (error == std::errc() && named && id >= 1 && id <= 65535) return static_cast<ClassId>(id);
  return Fail("expected a COCO name, \"ID NAME\" with an id in [1, 65535], or \"-\"; found \"" +
              line.substr(0, 60) + "\"");
}

}  // namespace

ClassTable Coco90() {
  ClassTable table;
  for (int id = 1; id <= 90; ++id) table.push_back(static_cast<ClassId>(id));
  return table;
}

ClassTable Coco80() {
  ClassTable table = Coco90();
  std::erase_if(table, [](ClassId id) {
    return std::find(kNotAnnotated.begin(), kNotAnnotated.end(), Raw(id)) != kNotAnnotated.end();
  });
  return table;
}

Result<ClassTable> LoadClassTable(const std::string& path) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, 1 << 20);
  if (!bytes) return tl::unexpected(bytes.error());
  std::istringstream text(std::string(
      WithoutByteOrderMark({reinterpret_cast<const char*>(bytes->data()), bytes->size()})));
  ClassTable table;
  int number = 0, blank = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    line = Trimmed(line);
    if (line.empty()) {  // empty lines are allowed only at the end
      ++blank;
      continue;
    }
    const std::string where = path + ":" + std::to_string(number) + ": ";
    if (blank > 0)
      return Fail(where + "expected no class after an empty line, because every line is one class");
    const Result<ClassId> id = ParseLine(line);
    if (!id) return Fail(where + id.error().message);
    table.push_back(*id);
  }
  if (table.empty()) return Fail(path + ": expected one class per line, found no classes");
  return table;
}

}  // namespace vismap
