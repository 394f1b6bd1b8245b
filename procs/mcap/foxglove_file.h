#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "base/result.h"
#include "mcap/mcap_writer.h"

namespace vismap {

/// A message of Foxglove, encoded: see foxglove.proto.
struct FoxgloveMessage {
  std::string schema;  ///< "foxglove.CompressedImage"
  std::string bytes;
};

/// When a message was recorded and published [us since 1970]. Times that MCAP or Foxglove cannot
/// store (before 1970, after the year 9999) become the nearest ones that they can.
struct MessageTimes {
  int64_t log_us = 0;
  int64_t publish_us = 0;
};

/// The types in foxglove.proto with all that they need, as MCAP's schema encoding "protobuf" has
/// them: a serialised google.protobuf.FileDescriptorSet.
std::string FoxgloveSchemas();

/// An MCAP file with messages of Foxglove. Topics and schemas are added as they come.
class FoxgloveFile {
 public:
  /// Fails, naming the file, when it cannot be created.
  static Result<FoxgloveFile> Create(const std::filesystem::path& path,
                                     const McapOptions& options = {});

  void Write(const std::string& topic, const MessageTimes& times, const FoxgloveMessage& message);
  /// A JSON object; `schema` is a name for its kind.
  void WriteJson(const std::string& topic, const MessageTimes& times, const std::string& schema,
                 const std::string& json);
  /// Gives the file its final name. Fails with the first write error.
  Result<void> Finish() { return writer_.Finish(); }

  /// Number of messages of each topic.
  const std::map<std::string, int64_t>& counts() const { return counts_; }
  uint64_t bytes() const { return writer_.bytes(); }  ///< of the file so far

 private:
  explicit FoxgloveFile(McapWriter writer) : writer_(std::move(writer)) {}
  uint16_t ChannelOf(const std::string& topic, const std::string& schema, const char* encoding);

  McapWriter writer_;
  std::map<std::string, uint16_t> schemas_, channels_;
  std::map<std::string, int64_t> counts_;
};

}  // namespace vismap
