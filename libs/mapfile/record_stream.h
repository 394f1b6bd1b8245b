#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap::mapfile {

/// The content of a record.
enum class RecordKind : uint32_t { kHeader = 1, kLabels = 2, kBlocks = 3, kEnd = 4 };

/// What every map file begins with. Its line break shows whether a file was copied as text.
inline constexpr std::string_view kMagic = "VISMAP\r\n";
/// Version of the format. A reader accepts no other one.
inline constexpr uint32_t kFormatVersion = 1;

/// The start of every map file: a name of eight bytes and the version (u32).
std::vector<uint8_t> FilePrefix();

/// Appends a record: kind (u32), length (u32), checksum over both and the content (u64), content.
/// Integers are little endian.
void AppendRecord(RecordKind kind, std::span<const uint8_t> content, std::vector<uint8_t>* file);

struct Record {
  RecordKind kind = RecordKind::kEnd;
  std::span<const uint8_t> content;  ///< part of the bytes given to SplitRecords
};

/// Number of bytes of a file from its start to the end of its first record, of which `start` must
/// have the first kFirstRecordAt; 0 = there is none.
inline constexpr size_t kFirstRecordAt = 28;
uint64_t EndOfFirstRecord(std::span<const uint8_t> start);

/// All records of a file. Fails on another kind of file, another version, a truncated file and a
/// wrong checksum.
Result<std::vector<Record>> SplitRecords(std::span<const uint8_t> file);

}  // namespace vismap::mapfile
