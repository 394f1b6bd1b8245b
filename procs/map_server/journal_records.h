#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/pose.h"
#include "wire/frame_key.h"

namespace vismap {

// The files of a FrameJournal: "VISMAPFJ", the version of the format (u32), then records, each with
// a checksum. Integers and numbers are little endian.

/// What identifies a frame of a map, and its pose.
struct JournaledFrame {
  FrameKey key;
  int64_t revision = 0;  ///< of the map with this frame
  Pose T_W_C = Pose::Identity();
  FrameKey previous;   ///< the frame that went into the map before; camera -1 = none
  std::string digest;  ///< of what the frame changed in the map, 32 characters
};

/// The new pose of a frame.
struct JournaledPose {
  FrameKey key;
  Pose T_W_C = Pose::Identity();
};

enum class JournalRecordKind : uint32_t {
  kFrame = 1,  ///< a frame that went into the map, after which the message follows
  kPoses = 2,  ///< new poses of frames before
};

/// The start of every file.
std::vector<uint8_t> JournalFilePrefix();

/// The bytes of a record.
std::vector<uint8_t> EncodeFrameRecord(const JournaledFrame& frame,
                                       std::span<const uint8_t> message);
std::vector<uint8_t> EncodePosesRecord(std::span<const JournaledPose> poses);

/// A record in the bytes of a file.
struct JournalRecord {
  JournalRecordKind kind = JournalRecordKind::kFrame;
  uint64_t offset = 0;               ///< of the record in the file
  std::span<const uint8_t> bytes;    ///< the whole record
  std::span<const uint8_t> content;  ///< part of it
};

/// The record that these bytes begin with, with `offset` 0. Fails when it is cut short, or damaged.
Result<JournalRecord> ReadJournalRecord(std::span<const uint8_t> bytes);

struct ScannedJournal {
  std::vector<JournalRecord> records;  ///< that are whole, in the order of the file
  std::vector<std::string> remarks;    ///< sentences that name what is not, without the file
};

/// Finds the records of a file. A damaged one is left out, and so is an end that was cut short.
ScannedJournal ScanJournal(std::span<const uint8_t> file);

/// What a frame record says; its message is what follows. Fails on content that is too short.
struct FrameRecord {
  JournaledFrame frame;
  std::span<const uint8_t> message;
};
Result<FrameRecord> DecodeFrameRecord(std::span<const uint8_t> content);
Result<std::vector<JournaledPose>> DecodePosesRecord(std::span<const uint8_t> content);

}  // namespace vismap
