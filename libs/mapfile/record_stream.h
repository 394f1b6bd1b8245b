#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace vismap::mapfile {

/// What a record holds.
enum class RecordKind : uint32_t { kHeader = 1, kLabels = 2, kBlocks = 3, kEnd = 4 };

/// Version of the format. A reader takes no other.
inline constexpr uint32_t kFormatVersion = 1;

/// The start of every map file: eight bytes of name, a version (u32).
std::vector<uint8_t> FilePrefix();

/// Appends a record: kind (u32), length (u32), checksum over both and the content (u64), content.
/// Integers are little endian.
void AppendRecord(RecordKind kind, std::span<const uint8_t> content, std::vector<uint8_t>* file);

struct Record {
  RecordKind kind = RecordKind::kEnd;
  std::span<const uint8_t> content;  ///< part of the bytes that were split
};

/// All records of a file. Fails on a foreign file, another version, a cut or a wrong checksum.
Result<std::vector<Record>> SplitRecords(std::span<const uint8_t> file);

}  // namespace vismap::mapfile
