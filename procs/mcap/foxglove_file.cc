#include "mcap/foxglove_file.h"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <set>

#include "foxglove.pb.h"

namespace vismap {
namespace {

constexpr int64_t kLastTime = int64_t{253402300799} * 1'000'000;  // the end of the year 9999 [us]

uint64_t NanosecondsOf(int64_t time_us) {
  return static_cast<uint64_t>(std::clamp<int64_t>(time_us, 0, kLastTime)) * 1000;
}

// Adds a file after all files that it imports.
void AddFile(const google::protobuf::FileDescriptor& file, std::set<std::string>* added,
             google::protobuf::FileDescriptorSet* set) {
  if (!added->insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) AddFile(*file.dependency(i), added, set);
  file.CopyTo(set->add_file());
}

}  // namespace

std::string FoxgloveSchemas() {
  google::protobuf::FileDescriptorSet set;
  std::set<std::string> added;
  AddFile(*foxglove::SceneUpdate::descriptor()->file(), &added, &set);
  return set.SerializeAsString();
}

Result<FoxgloveFile> FoxgloveFile::Create(const std::filesystem::path& path,
                                          const McapOptions& options) {
  Result<McapWriter> writer = McapWriter::Create(path, options);
  if (!writer) return tl::unexpected(writer.error());
  return FoxgloveFile(std::move(*writer));
}

uint16_t FoxgloveFile::ChannelOf(const std::string& topic, const std::string& schema,
                                 const char* encoding) {
  if (const auto found = channels_.find(topic); found != channels_.end()) return found->second;
  auto kind = schemas_.find(schema);
  if (kind == schemas_.end()) {
    const bool json = std::string(encoding) == "json";
    const uint16_t id = json ? writer_.AddSchema(schema, "jsonschema", R"({"type": "object"})")
                             : writer_.AddSchema(schema, "protobuf", FoxgloveSchemas());
    kind = schemas_.emplace(schema, id).first;
  }
  return channels_.emplace(topic, writer_.AddChannel(topic, encoding, kind->second)).first->second;
}

void FoxgloveFile::Write(const std::string& topic, const MessageTimes& times,
                         const FoxgloveMessage& message) {
  const uint16_t channel = ChannelOf(topic, message.schema, "protobuf");
  writer_.AddMessage(channel, {NanosecondsOf(times.log_us), NanosecondsOf(times.publish_us)},
                     message.bytes);
  ++counts_[topic];
}

void FoxgloveFile::WriteJson(const std::string& topic, const MessageTimes& times,
                             const std::string& schema, const std::string& json) {
  const uint16_t channel = ChannelOf(topic, schema, "json");
  writer_.AddMessage(channel, {NanosecondsOf(times.log_us), NanosecondsOf(times.publish_us)}, json);
  ++counts_[topic];
}

}  // namespace vismap
