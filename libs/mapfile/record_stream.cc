#include "mapfile/record_stream.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

#include "base/digest.h"
#include "base/require.h"

namespace vismap::mapfile {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little endian");

constexpr size_t kPrefixBytes = 12;
constexpr size_t kRecordHeadBytes = 16;

struct RecordHead {
  uint32_t kind = 0;
  uint32_t length = 0;
};

uint64_t ChecksumOf(const RecordHead& head, std::span<const uint8_t> content) {
  const std::array<uint64_t, 2> parts{Checksum64(content),
                                      static_cast<uint64_t>(head.kind) << 32 | head.length};
  return Checksum64({reinterpret_cast<const uint8_t*>(parts.data()), sizeof(parts)});
}

template <typename T>
void Put(const T& value, std::vector<uint8_t>* file) {
  const size_t at = file->size();
  file->resize(at + sizeof(T));
  std::memcpy(file->data() + at, &value, sizeof(T));
}

}  // namespace

std::vector<uint8_t> FilePrefix() {
  std::vector<uint8_t> file(kMagic.begin(), kMagic.end());
  Put(kFormatVersion, &file);
  return file;
}

void AppendRecord(RecordKind kind, std::span<const uint8_t> content, std::vector<uint8_t>* file) {
  Require(content.size() <= std::numeric_limits<uint32_t>::max(), "a record is below 4 GiB");
  const RecordHead head{static_cast<uint32_t>(kind), static_cast<uint32_t>(content.size())};
  Put(head, file);
  Put(ChecksumOf(head, content), file);
  file->insert(file->end(), content.begin(), content.end());
}

static_assert(kFirstRecordAt == kPrefixBytes + kRecordHeadBytes);

uint64_t EndOfFirstRecord(std::span<const uint8_t> start) {
  if (start.size() < kFirstRecordAt) return 0;
  RecordHead head;
  std::memcpy(&head, start.data() + kPrefixBytes, sizeof(head));
  return kFirstRecordAt + uint64_t{head.length};
}

Result<std::vector<Record>> SplitRecords(std::span<const uint8_t> file) {
  if (file.size() < kPrefixBytes || !std::equal(kMagic.begin(), kMagic.end(), file.begin())) {
    return Fail("it is not a map file of vismap");
  }
  uint32_t version = 0;
  std::memcpy(&version, file.data() + kMagic.size(), sizeof(version));
  if (version != kFormatVersion) {
    return Fail("expected map format " + std::to_string(kFormatVersion) + ", found " +
                std::to_string(version) +
                (version > kFormatVersion ? "; a newer version of vismap wrote it" : ""));
  }
  std::vector<Record> records;
  for (size_t at = kPrefixBytes; at < file.size();) {
    const std::string place = "record " + std::to_string(records.size() + 1) + " at byte " +
                              std::to_string(at) + " of " + std::to_string(file.size());
    if (file.size() - at < kRecordHeadBytes) return Fail(place + " is truncated");
    RecordHead head;
    uint64_t checksum = 0;
    std::memcpy(&head, file.data() + at, sizeof(head));
    std::memcpy(&checksum, file.data() + at + sizeof(head), sizeof(checksum));
    at += kRecordHeadBytes;
    if (file.size() - at < head.length) {
      return Fail(place + " is truncated: expected " + std::to_string(head.length) +
                  " bytes, found " + std::to_string(file.size() - at));
    }
    const std::span<const uint8_t> content = file.subspan(at, head.length);
    if (ChecksumOf(head, content) != checksum)
      return Fail(place + " is damaged: its checksum is wrong");
    records.push_back({static_cast<RecordKind>(head.kind), content});
    at += head.length;
  }
  return records;
}

}  // namespace vismap::mapfile
