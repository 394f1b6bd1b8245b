#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/part_file.h"
#include "base/result.h"

namespace vismap {

// This room writes MCAP files (version 0 of the format) with messages as Foxglove defines them, so
// that Foxglove, Lichtblick and Rerun show a run. An MCAP file is a list of records: u8 opcode, u64
// size, content, little-endian. Messages, with the schemas and channels that they need, are in
// chunks, each followed by an index per channel; a summary at the end says where the chunks are.

/// A time of a message in both forms that MCAP has [ns since 1970].
struct McapTimes {
  uint64_t log_ns = 0;      ///< when it was recorded
  uint64_t publish_ns = 0;  ///< when it was published
};

struct McapOptions {
  size_t chunk_bytes = size_t{4} << 20;  ///< a chunk ends when its records have so many bytes
  bool compress = true;                  ///< by zstd, where that makes a chunk smaller
};

/// Writes an MCAP file with chunks, indexes, a summary and checksums. An interrupted
/// program leaves no partial file, see PartFile. Memory: one chunk, and about 100 bytes for each
/// chunk and channel in it.
class McapWriter {
 public:
  /// Fails, naming the file, when it cannot be created.
  static Result<McapWriter> Create(const std::filesystem::path& path,
                                   const McapOptions& options = {});

  /// Returns the id of the schema, 1, 2, ...; at most 65535.
  uint16_t AddSchema(const std::string& name, const std::string& encoding, std::string_view data);
  /// Returns the id of the channel, 0, 1, ...; at most 65536. `schema` = 0: it has none.
  uint16_t AddChannel(const std::string& topic, const std::string& message_encoding,
                      uint16_t schema);
  /// Appends a message. Times need not ascend.
  void AddMessage(uint16_t channel, const McapTimes& times, std::string_view data);

  /// Writes the summary and gives the file its final name. Fails with the first write error.
  Result<void> Finish();

  int64_t messages() const { return static_cast<int64_t>(messages_); }
  uint64_t bytes() const { return position_; }  ///< written so far

 private:
  using Bytes = std::vector<uint8_t>;
  struct TimeRange {
    uint64_t first = 0, last = 0;  // 0 = there is no message
    void Extend(uint64_t time, bool is_first);
  };
  struct ChannelState {
    Bytes record;
    uint64_t messages = 0;
    std::vector<std::pair<uint64_t, uint64_t>> in_chunk;  // log time, offset in the chunk
  };

  McapWriter(PartFile file, const McapOptions& options);
  void WriteOut(std::span<const uint8_t> bytes);
  void EndChunk();
  std::map<uint16_t, uint64_t> WriteMessageIndexes();
  Bytes Statistics() const;
  Bytes Summary() const;

  PartFile file_;
  McapOptions options_;
  uint64_t position_ = 0;
  uint32_t crc_ = 0;  // of all bytes so far
  std::vector<Bytes> schemas_;
  std::vector<ChannelState> channels_;
  uint64_t messages_ = 0;
  TimeRange all_times_;

  Bytes chunk_;  // records of the chunk that is being made
  uint64_t chunk_messages_ = 0;
  TimeRange chunk_times_;
  std::vector<Bytes> chunk_indexes_;
};

}  // namespace vismap
