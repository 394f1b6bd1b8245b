#include "detection/onnx_input.h"

#include <algorithm>
#include <optional>

namespace vismap {
namespace {

using Bytes = std::span<const uint8_t>;

/// A field of a protobuf message: a number, or bytes, which may be a message themselves.
struct Field {
  uint64_t id = 0;
  uint64_t number = 0;
  Bytes bytes;
};

// Field numbers of onnx.proto.
constexpr uint64_t kModelGraph = 7, kGraphInput = 11, kValueType = 2, kTypeTensor = 1,
                   kTensorShape = 2, kShapeDimension = 1, kDimensionValue = 1;

/// Reads the varint at the front and removes it. None if it is not valid.
std::optional<uint64_t> ReadVarint(Bytes* rest) {
  uint64_t value = 0;
  for (int shift = 0; shift < 64 && !rest->empty(); shift += 7) {
    const uint8_t byte = rest->front();
    *rest = rest->subspan(1);
    value |= static_cast<uint64_t>(byte & 127) << shift;
    if (byte < 128) return value;
  }
  return std::nullopt;
}

std::optional<Bytes> ReadBytes(Bytes* rest, uint64_t count) {
  if (count > rest->size()) return std::nullopt;
  const Bytes taken = rest->first(static_cast<size_t>(count));
  *rest = rest->subspan(static_cast<size_t>(count));
  return taken;
}

/// Reads the field at the front and removes it. None at the end, or if there is no valid field.
std::optional<Field> ReadField(Bytes* rest) {
  const auto key = ReadVarint(rest);
  if (!key) return std::nullopt;
  Field field{*key >> 3, 0, {}};
  const uint64_t wire = *key & 7;
  if (wire == 0) {
    const auto number = ReadVarint(rest);
    field.number = number.value_or(0);
    return number ? std::optional(field) : std::nullopt;
  }
  const auto size = wire == 2   ? ReadVarint(rest)
                    : wire == 1 ? std::optional<uint64_t>(8)
                    : wire == 5 ? std::optional<uint64_t>(4)
                                : std::nullopt;
  const auto bytes = size ? ReadBytes(rest, *size) : std::nullopt;
  if (!bytes) return std::nullopt;
  field.bytes = *bytes;
  return field;
}

/// All fields with this id in a message.
std::vector<Field> FieldsOf(Bytes message, uint64_t id) {
  std::vector<Field> fields;
  while (const auto field = ReadField(&message)) {
    if (field->id == id) fields.push_back(*field);
  }
  return fields;
}

/// The bytes of the first field with this id; empty if there is none.
Bytes Inside(Bytes message, uint64_t id) {
  const std::vector<Field> fields = FieldsOf(message, id);
  return fields.empty() ? Bytes() : fields.front().bytes;
}

/// The shape of an input; open sides are 0.
std::vector<int> ShapeOf(Bytes input) {
  const Bytes shape = Inside(Inside(Inside(input, kValueType), kTypeTensor), kTensorShape);
  std::vector<int> sides;
  for (const Field& dimension : FieldsOf(shape, kShapeDimension)) {
    const std::vector<Field> value = FieldsOf(dimension.bytes, kDimensionValue);
    const uint64_t side = value.empty() ? 0 : value.front().number;
    sides.push_back(side <= 16384 ? static_cast<int>(side) : 0);  // a name or -1 means an open side
  }
  return sides;
}

}  // namespace

std::vector<int> OnnxImageShape(std::span<const uint8_t> model) {
  for (const Field& input : FieldsOf(Inside(model, kModelGraph), kGraphInput)) {
    const std::vector<int> shape = ShapeOf(input.bytes);
    if (shape.size() == 4 && shape[1] == 3) return shape;
  }
  return {};
}

}  // namespace vismap
