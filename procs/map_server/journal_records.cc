#include "map_server/journal_records.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

#include "base/digest.h"

namespace vismap {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little endian");

constexpr std::string_view kFileMagic = "VISMAPFJ";
constexpr uint32_t kFileVersion = 1;
constexpr size_t kFilePrefixBytes = 12;
constexpr std::string_view kRecordMagic = "VFJR";
constexpr size_t kDigestLength = 32;

// As they stand in the file.
struct RecordStart {
  char magic[4];
  uint32_t kind;
  uint64_t length;  // of the content
  uint64_t checksum;
};
struct StoredPose {
  int64_t utime;
  int32_t camera_id;
  uint32_t unused;
  double T_W_C[16];
};
struct StoredFrame {
  StoredPose pose;
  int64_t revision;
  int64_t previous_utime;
  int32_t previous_camera_id;
  uint32_t unused;
  char digest[kDigestLength];
};
static_assert(sizeof(RecordStart) == 24 && sizeof(StoredPose) == 144 && sizeof(StoredFrame) == 200);

using StoredMatrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

StoredPose Store(const FrameKey& key, const Pose& T_W_C) {
  StoredPose stored{key.utime, Raw(key.camera_id), 0, {}};
  Eigen::Map<StoredMatrix>(stored.T_W_C) = T_W_C.matrix();
  return stored;
}

JournaledPose Restore(const StoredPose& stored) {
  JournaledPose pose{{CameraId{stored.camera_id}, stored.utime}, Pose::Identity()};
  pose.T_W_C.matrix() = Eigen::Map<const StoredMatrix>(stored.T_W_C);
  return pose;
}

uint64_t ChecksumOf(const RecordStart& start, std::span<const uint8_t> content) {
  const uint64_t parts[3] = {start.kind, start.length, Checksum64(content)};
  return Checksum64({reinterpret_cast<const uint8_t*>(parts), sizeof(parts)});
}

// `parts` one after the other are the content.
std::vector<uint8_t> EncodeRecord(JournalRecordKind kind, std::span<const uint8_t> first,
                                  std::span<const uint8_t> second) {
  std::vector<uint8_t> bytes(sizeof(RecordStart));
  bytes.reserve(sizeof(RecordStart) + first.size() + second.size());
  bytes.insert(bytes.end(), first.begin(), first.end());
  bytes.insert(bytes.end(), second.begin(), second.end());
  RecordStart start{{}, static_cast<uint32_t>(kind), first.size() + second.size(), 0};
  std::copy(kRecordMagic.begin(), kRecordMagic.end(), start.magic);
  start.checksum = ChecksumOf(start, std::span(bytes).subspan(sizeof(start)));
  std::memcpy(bytes.data(), &start, sizeof(start));
  return bytes;
}

template <typename T>
std::span<const uint8_t> BytesOfValue(const T& value) {
  return {reinterpret_cast<const uint8_t*>(&value), sizeof(value)};
}

// Where the next whole record begins at or after `from`; the end of the file when there is none.
size_t NextRecord(std::span<const uint8_t> file, size_t from) {
  for (auto at = file.begin() + static_cast<std::ptrdiff_t>(from);; ++at) {
    at = std::search(at, file.end(), kRecordMagic.begin(), kRecordMagic.end());
    if (at == file.end()) return file.size();
    const auto offset = static_cast<size_t>(at - file.begin());
    if (ReadJournalRecord(file.subspan(offset))) return offset;
  }
}

}  // namespace

std::vector<uint8_t> JournalFilePrefix() {
  std::vector<uint8_t> prefix(kFileMagic.begin(), kFileMagic.end());
  const std::span<const uint8_t> version = BytesOfValue(kFileVersion);
  prefix.insert(prefix.end(), version.begin(), version.end());
  return prefix;
}

std::vector<uint8_t> EncodeFrameRecord(const JournaledFrame& frame,
                                       std::span<const uint8_t> message) {
  StoredFrame stored{Store(frame.key, frame.T_W_C),
                     frame.revision,
                     frame.previous.utime,
                     Raw(frame.previous.camera_id),
                     0,
                     {}};
  std::copy_n(frame.digest.begin(), std::min(frame.digest.size(), kDigestLength), stored.digest);
  return EncodeRecord(JournalRecordKind::kFrame, BytesOfValue(stored), message);
}

std::vector<uint8_t> EncodePosesRecord(std::span<const JournaledPose> poses) {
  std::vector<StoredPose> stored;
  for (const JournaledPose& pose : poses) stored.push_back(Store(pose.key, pose.T_W_C));
  return EncodeRecord(
      JournalRecordKind::kPoses,
      {reinterpret_cast<const uint8_t*>(stored.data()), stored.size() * sizeof(StoredPose)}, {});
}

Result<JournalRecord> ReadJournalRecord(std::span<const uint8_t> bytes) {
  RecordStart start{};
  if (bytes.size() < sizeof(start)) return Fail("the record is cut short");
  std::memcpy(&start, bytes.data(), sizeof(start));
  if (std::string_view(start.magic, sizeof(start.magic)) != kRecordMagic)
    return Fail("expected a record, found something else");
  if (start.length > bytes.size() - sizeof(start)) return Fail("the record is cut short");
  const std::span<const uint8_t> content = bytes.subspan(sizeof(start), start.length);
  if (ChecksumOf(start, content) != start.checksum) return Fail("the checksum is wrong");
  return JournalRecord{static_cast<JournalRecordKind>(start.kind), 0,
                       bytes.first(sizeof(start) + start.length), content};
}

ScannedJournal ScanJournal(std::span<const uint8_t> file) {
  ScannedJournal scanned;
  const std::vector<uint8_t> prefix = JournalFilePrefix();
  if (file.size() < prefix.size() || !std::equal(prefix.begin(), prefix.end(), file.begin())) {
    scanned.remarks.push_back("it is no journal of frames of format " +
                              std::to_string(kFileVersion) + " and is not used");
    return scanned;
  }
  for (size_t at = kFilePrefixBytes; at < file.size();) {
    Result<JournalRecord> record = ReadJournalRecord(file.subspan(at));
    if (record) {
      record->offset = at;
      at += record->bytes.size();
      scanned.records.push_back(*record);
      continue;
    }
    const size_t next = NextRecord(file, at + 1);
    const std::string bytes = std::to_string(next - at) + " bytes from byte " + std::to_string(at);
    scanned.remarks.push_back(
        next < file.size() ? bytes + " on are damaged and left out: " + record.error().message
                           : "its end, " + bytes + " on, is cut short or damaged");
    at = next;
  }
  return scanned;
}

Result<FrameRecord> DecodeFrameRecord(std::span<const uint8_t> content) {
  StoredFrame stored{};
  if (content.size() < sizeof(stored)) return Fail("the record of a frame is too short");
  std::memcpy(&stored, content.data(), sizeof(stored));
  const JournaledPose pose = Restore(stored.pose);
  return FrameRecord{{pose.key,
                      stored.revision,
                      pose.T_W_C,
                      {CameraId{stored.previous_camera_id}, stored.previous_utime},
                      std::string(stored.digest, kDigestLength)},
                     content.subspan(sizeof(stored))};
}

Result<std::vector<JournaledPose>> DecodePosesRecord(std::span<const uint8_t> content) {
  if (content.size() % sizeof(StoredPose) != 0)
    return Fail("the record of new poses ends within a pose");
  std::vector<JournaledPose> poses;
  for (size_t at = 0; at < content.size(); at += sizeof(StoredPose)) {
    StoredPose stored{};
    std::memcpy(&stored, content.data() + at, sizeof(stored));
    poses.push_back(Restore(stored));
  }
  return poses;
}

}  // namespace vismap
