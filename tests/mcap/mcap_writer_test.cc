#include "mcap/mcap_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <optional>

#include "base/file.h"
#include "codecs/zstd_codec.h"
#include "support/mutations.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using McapBytes = std::vector<uint8_t>;

/// Reads little-endian numbers and records from bytes, from front to back.
class McapCursor {
 public:
  explicit McapCursor(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool at_end() const { return bytes_.empty(); }
  template <typename Number>
  Number Take() {
    Number value{};
    std::memcpy(&value, TakeBytes(sizeof(Number)).data(), sizeof(Number));
    return value;
  }
  std::span<const uint8_t> TakeBytes(size_t size) {
    if (size > bytes_.size()) throw std::runtime_error("the bytes end early");
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }
  std::string TakeText() {
    const auto text = TakeBytes(Take<uint32_t>());
    return {text.begin(), text.end()};
  }

 private:
  std::span<const uint8_t> bytes_;
};

struct McapRecord {
  uint8_t opcode = 0;
  uint64_t offset = 0;  // of the record
  std::span<const uint8_t> content;
};

std::vector<McapRecord> RecordsIn(std::span<const uint8_t> bytes, uint64_t offset) {
  std::vector<McapRecord> records;
  McapCursor cursor(bytes);
  while (!cursor.at_end()) {
    McapRecord record{cursor.Take<uint8_t>(), offset, {}};
    record.content = cursor.TakeBytes(cursor.Take<uint64_t>());
    offset += 9 + record.content.size();
    records.push_back(record);
  }
  return records;
}

/// All records of a file between its two magics.
std::vector<McapRecord> RecordsOf(const McapBytes& file) {
  return RecordsIn(std::span<const uint8_t>(file).subspan(8, file.size() - 16), 8);
}

std::vector<McapRecord> OfKind(const std::vector<McapRecord>& records, uint8_t opcode) {
  std::vector<McapRecord> found;
  for (const McapRecord& record : records)
    if (record.opcode == opcode) found.push_back(record);
  return found;
}

McapBytes RecordsOfChunk(const McapRecord& chunk) {
  McapCursor cursor(chunk.content);
  cursor.TakeBytes(16);
  const auto size = cursor.Take<uint64_t>();
  const auto crc = cursor.Take<uint32_t>();
  const std::string compression = cursor.TakeText();
  const auto stored = cursor.TakeBytes(cursor.Take<uint64_t>());
  McapBytes records(stored.begin(), stored.end());
  if (compression == "zstd") records = *DecompressBytes(stored, size, size);
  EXPECT_EQ(records.size(), size);
  EXPECT_EQ(crc32(0, records.data(), static_cast<uInt>(size)), crc);
  return records;
}

McapBytes Finished(McapWriter& writer, const std::filesystem::path& path) {
  const Result<void> finished = writer.Finish();
  EXPECT_TRUE(finished) << finished.error().message;
  return *ReadFileBytes(path);
}

std::string Hex(std::span<const uint8_t> bytes) {
  std::string text;
  for (const uint8_t byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", byte);
    text += digits;
  }
  return text;
}

TEST(McapWriter, WritesTheBytesOfTheSpecification) {
  const TempFolder folder;
  Result<McapWriter> writer = McapWriter::Create(folder / "a.mcap", {1000, false});
  ASSERT_TRUE(writer);
  const uint16_t schema = writer->AddSchema("S", "jsonschema", "{}");
  const uint16_t channel = writer->AddChannel("/t", "json", schema);
  writer->AddMessage(channel, {0x0102, 0x0304}, "[7]");
  const McapBytes file = Finished(*writer, folder / "a.mcap");

  const std::string magic = "894d434150300d0a";
  const std::string header =
      "010e00000000000000"
      "00000000"
      "06000000"
      "7669736d6170";
  const std::string schema_record =
      "031b00000000000000"
      "0100"
      "01000000"
      "53"
      "0a000000"
      "6a736f6e736368656d61"
      "02000000"
      "7b7d";
  const std::string channel_record =
      "041600000000000000"
      "0000"
      "0100"
      "02000000"
      "2f74"
      "04000000"
      "6a736f6e"
      "00000000";
  const std::string message =
      "051900000000000000"
      "0000"
      "00000000"
      "0201000000000000"
      "0403000000000000"
      "5b375d";
  const std::string text = Hex(file);
  const std::string records = schema_record + channel_record + message;
  EXPECT_THAT(text, ::testing::StartsWith(magic + header + "06"));
  EXPECT_THAT(text, ::testing::EndsWith(magic));
  EXPECT_THAT(text, HasSubstr(records));
  // The index of the channel: one message, at the end of the schema and the channel.
  const std::string offset = "4300000000000000";
  EXPECT_THAT(text, HasSubstr("071600000000000000"
                              "0000"
                              "10000000"
                              "0201000000000000" +
                              offset));
  EXPECT_THAT(text, HasSubstr("0f0400000000000000"));  // end of the data
  EXPECT_EQ((schema_record.size() + channel_record.size()) / 2, 0x43u);
}

TEST(McapWriter, AFileWithoutMessagesIsComplete) {
  const TempFolder folder;
  Result<McapWriter> writer = McapWriter::Create(folder / "a.mcap");
  const McapBytes file = Finished(*writer, folder / "a.mcap");
  std::vector<uint8_t> opcodes;
  for (const McapRecord& record : RecordsOf(file)) opcodes.push_back(record.opcode);
  EXPECT_THAT(opcodes, ElementsAre(1, 15, 11, 14, 2));
}

/// Messages of random sizes on some channels, and the file with them.
struct RandomFile {
  struct Written {
    uint16_t channel;
    McapTimes times;
    std::string data;
  };
  std::vector<Written> messages;
  McapBytes file;
};

RandomFile WriteRandomFile(const TempFolder& folder, bool compress) {
  RandomFile random;
  TestRandom dice(compress ? 1 : 2);
  Result<McapWriter> writer = McapWriter::Create(folder / "r.mcap", {5000, compress});
  const uint16_t schema = writer->AddSchema("S", "jsonschema", "{}");
  std::vector<uint16_t> channels;
  for (int i = 0; i < 300; ++i) {
    if (channels.empty() || dice.Below(40) == 0)
      channels.push_back(writer->AddChannel("/" + std::to_string(i), "json", schema));
    RandomFile::Written message{channels[dice.Below(channels.size())],
                                {dice.Below(1000), dice.Below(1000)},
                                std::string(dice.Below(10) == 0 ? 9000 : dice.Below(400), ' ')};
    for (char& byte : message.data) byte = static_cast<char>('a' + dice.Below(3));
    writer->AddMessage(message.channel, message.times, message.data);
    random.messages.push_back(std::move(message));
  }
  random.file = Finished(*writer, folder / "r.mcap");
  return random;
}

/// Checks the message at `offset` of the records of a chunk.
void ExpectMessage(const McapBytes& records, uint64_t offset, uint64_t time,
                   const RandomFile::Written& expected) {
  McapCursor cursor(std::span<const uint8_t>(records).subspan(offset));
  EXPECT_EQ(cursor.Take<uint8_t>(), 5);
  const auto size = cursor.Take<uint64_t>();
  ASSERT_EQ(size, 22 + expected.data.size());
  EXPECT_EQ(cursor.Take<uint16_t>(), expected.channel);
  cursor.Take<uint32_t>();
  EXPECT_EQ(cursor.Take<uint64_t>(), time);
  EXPECT_EQ(time, expected.times.log_ns);
  EXPECT_EQ(cursor.Take<uint64_t>(), expected.times.publish_ns);
  const auto data = cursor.TakeBytes(expected.data.size());
  EXPECT_EQ(std::string(data.begin(), data.end()), expected.data);
}

/// Follows the summary of a file: footer, chunk indexes, message indexes. Expects all messages.
void ExpectIndexed(const RandomFile& random) {
  const std::vector<McapRecord> records = RecordsOf(random.file);
  McapCursor footer(records.back().content);
  const auto summary_start = footer.Take<uint64_t>();
  const uint64_t crc_end = random.file.size() - 8 - 4;
  footer.Take<uint64_t>();
  EXPECT_EQ(footer.Take<uint32_t>(), crc32(0, random.file.data() + summary_start,
                                           static_cast<uInt>(crc_end - summary_start)));
  std::map<uint16_t, std::vector<RandomFile::Written>> by_channel;
  for (const RandomFile::Written& message : random.messages)
    by_channel[message.channel].push_back(message);
  std::map<uint16_t, size_t> read;
  for (const McapRecord& index : OfKind(records, 8)) {
    McapCursor cursor(index.content);
    const auto first = cursor.Take<uint64_t>(), last = cursor.Take<uint64_t>();
    const auto start = cursor.Take<uint64_t>(), length = cursor.Take<uint64_t>();
    const auto chunk =
        RecordsIn(std::span<const uint8_t>(random.file).subspan(start, length), start);
    ASSERT_EQ(chunk.size(), 1u);
    const McapBytes chunk_records = RecordsOfChunk(chunk.front());
    McapCursor offsets(cursor.TakeBytes(cursor.Take<uint32_t>()));
    while (!offsets.at_end()) {
      const auto channel = offsets.Take<uint16_t>();
      const auto place = offsets.Take<uint64_t>();
      McapCursor entries(std::span<const uint8_t>(random.file).subspan(place + 9));
      EXPECT_EQ(random.file[place], 7);
      EXPECT_EQ(entries.Take<uint16_t>(), channel);
      McapCursor pairs(entries.TakeBytes(entries.Take<uint32_t>()));
      while (!pairs.at_end()) {
        const auto time = pairs.Take<uint64_t>(), offset = pairs.Take<uint64_t>();
        EXPECT_GE(time, first);
        EXPECT_LE(time, last);
        ASSERT_LT(read[channel], by_channel[channel].size());
        ExpectMessage(chunk_records, offset, time, by_channel[channel][read[channel]++]);
      }
    }
  }
  size_t total = 0;
  for (const auto& [channel, count] : read) total += count;
  EXPECT_EQ(total, random.messages.size());
}

TEST(McapWriter, TheIndexLeadsToEveryMessage) {
  const TempFolder folder;
  ExpectIndexed(WriteRandomFile(folder, true));
  ExpectIndexed(WriteRandomFile(folder, false));
}

TEST(McapWriter, ChunksAreCompressedAndBounded) {
  const TempFolder folder;
  const RandomFile packed = WriteRandomFile(folder, true), plain = WriteRandomFile(folder, false);
  EXPECT_LT(packed.file.size(), plain.file.size() / 2);
  for (const McapRecord& chunk : OfKind(RecordsOf(plain.file), 6))
    EXPECT_LT(chunk.content.size(), 5000u + 9500u);
}

TEST(McapWriter, AnUnfinishedFileIsRemoved) {
  const TempFolder folder;
  {
    Result<McapWriter> writer = McapWriter::Create(folder / "a.mcap");
    writer->AddChannel("/t", "json", 0);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(McapWriter, ErrorsNameTheFile) {
  EXPECT_THAT(McapWriter::Create("/nonexistent/a.mcap").error().message,
              HasSubstr("/nonexistent/a.mcap"));
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "a.mcap.part");
  Result<McapWriter> writer = McapWriter::Create(folder / "a.mcap");
  ASSERT_TRUE(writer);
  const uint16_t channel = writer->AddChannel("/t", "json", 0);
  writer->AddMessage(channel, {}, std::string(100000, 'x'));
  EXPECT_THAT(writer->Finish().error().message, HasSubstr("a.mcap.part: cannot write"));
}

}  // namespace
}  // namespace vismap
