#include "logs/log_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <sys/stat.h>

#include "base/file.h"
#include "logs/recorded_run.h"
#include "support/log_builder.h"
#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Contents {
  std::vector<LogEvent> events;
  std::vector<LogDamage> damage;
  std::vector<std::string> data() const { return data_; }
  std::vector<std::string> data_;
};

Contents ReadAll(const std::filesystem::path& path) {
  Result<LogReader> reader = LogReader::Open(path);
  EXPECT_TRUE(reader) << reader.error().message;
  Contents contents;
  const auto read = ForEachEvent(
      *reader,
      [&](const LogEvent& event) -> Result<void> {
        const auto bytes = reader->ReadData(event);
        EXPECT_TRUE(bytes) << bytes.error().message;
        contents.data_.emplace_back(bytes->begin(), bytes->end());
        contents.events.push_back(event);
        return {};
      },
      [&](const LogDamage& damage) { contents.damage.push_back(damage); });
  EXPECT_TRUE(read) << read.error().message;
  return contents;
}

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

/// Three events "first", "second", "third"; 28 bytes of head and a channel of 4 letters each.
struct ThreeEvents {
  ThreeEvents() {
    LogBuilder builder;
    builder.AddBytes("CHAN", Bytes("first"));
    builder.AddBytes("CHAN", Bytes("second"));
    builder.AddBytes("CHAN", Bytes("third"));
    bytes = *ReadFileBytes(builder.Finish());
  }
  Contents Read() const {
    folder.Write("log", std::span<const uint8_t>(bytes));
    return ReadAll(folder / "log");
  }
  static constexpr size_t kHead = 32, kFirst = 0, kSecond = kHead + 5, kThird = kSecond + kHead + 6;

  TempFolder folder;
  std::vector<uint8_t> bytes;
};

TEST(LogReader, ReadsTheLogOfLogWriter) {
  const Contents log = ThreeEvents().Read();
  EXPECT_THAT(log.data(), ElementsAre("first", "second", "third"));
  EXPECT_THAT(log.damage, IsEmpty());
  EXPECT_EQ(log.events[1].number, 1);
  EXPECT_EQ(log.events[1].timestamp, log.events[0].timestamp + 10000);
  EXPECT_EQ(log.events[1].channel, "CHAN");
  EXPECT_EQ(log.events[1].offset, ThreeEvents::kSecond);
}

TEST(LogReader, ChannelsMayHaveAnyName) {
  LogBuilder builder;
  builder.AddBytes("My Channel", {1}).AddBytes("KAMERA_\xC3\x9C", {2}).AddBytes("x y", {3});
  const Contents log = ReadAll(builder.Finish());
  EXPECT_THAT(log.damage, IsEmpty());
  ASSERT_EQ(log.events.size(), 3u);
  EXPECT_EQ(log.events[0].channel, "My Channel");
  EXPECT_EQ(log.events[1].channel, "KAMERA_\xC3\x9C");
}

TEST(LogReader, AgreesWithTheReaderOfLcm) {
  LogBuilder builder;
  builder.Frame(1000).AddBytes("EMPTY", {}).Detections(1000);
  const std::string path = builder.Finish();
  const Contents ours = ReadAll(path);
  lcm_eventlog_t* log = lcm_eventlog_create(path.c_str(), "r");
  ASSERT_NE(log, nullptr);
  for (size_t i = 0; i < ours.events.size(); ++i) {
    lcm_eventlog_event_t* theirs = lcm_eventlog_read_next_event(log);
    ASSERT_NE(theirs, nullptr);
    EXPECT_EQ(theirs->channel, ours.events[i].channel);
    EXPECT_EQ(theirs->eventnum, ours.events[i].number);
    EXPECT_EQ(theirs->timestamp, ours.events[i].timestamp);
    EXPECT_EQ(std::string(static_cast<char*>(theirs->data), static_cast<size_t>(theirs->datalen)),
              ours.data()[i]);
    lcm_eventlog_free_event(theirs);
  }
  EXPECT_EQ(lcm_eventlog_read_next_event(log), nullptr);
  lcm_eventlog_destroy(log);
}

TEST(LogReader, ReportsEveryTruncation) {
  const ThreeEvents whole;
  for (size_t size = 0; size < whole.bytes.size(); ++size) {
    ThreeEvents cut;
    cut.bytes.resize(size);
    const Contents log = cut.Read();
    const size_t events = size >= ThreeEvents::kThird ? 2 : (size >= ThreeEvents::kSecond ? 1 : 0);
    ASSERT_EQ(log.events.size(), events) << size;
    const bool at_border =
        size == ThreeEvents::kFirst || size == ThreeEvents::kSecond || size == ThreeEvents::kThird;
    ASSERT_EQ(log.damage.size(), at_border ? 0u : 1u) << size;
    if (!at_border) {
      EXPECT_TRUE(log.damage[0].truncated) << size;
      EXPECT_EQ(log.damage[0].offset + log.damage[0].bytes, size);
    }
  }
}

TEST(LogReader, FindsTheNextEventAfterDamage) {
  ThreeEvents log;
  log.bytes[ThreeEvents::kSecond] ^= 0xff;  // sync word
  Contents read = log.Read();
  EXPECT_THAT(read.data(), ElementsAre("first", "third"));
  ASSERT_EQ(read.damage.size(), 1u);
  EXPECT_EQ(read.damage[0].offset, ThreeEvents::kSecond);
  EXPECT_EQ(read.damage[0].bytes, ThreeEvents::kThird - ThreeEvents::kSecond);
  EXPECT_FALSE(read.damage[0].truncated);
}

TEST(LogReader, WrongSizesLoseOneEventOnly) {
  struct Lie {
    size_t byte;    // of the second event
    uint8_t value;  // there
  };
  // Size of the data: beyond the end of the file, slightly too large, negative, larger than any
  // message. Then the same for the size of the channel name.
  for (const Lie lie : {Lie{25, 0x01}, Lie{27, 20}, Lie{24, 0xff}, Lie{24, 0x7f}, Lie{20, 0x80},
                        Lie{23, 0}, Lie{23, 64}}) {
    ThreeEvents log;
    log.bytes[ThreeEvents::kSecond + lie.byte] = lie.value;
    const Contents read = log.Read();
    EXPECT_THAT(read.data(), ElementsAre("first", "third")) << lie.byte;
    ASSERT_EQ(read.damage.size(), 1u) << lie.byte;
    EXPECT_EQ(read.damage[0].bytes, ThreeEvents::kThird - ThreeEvents::kSecond) << lie.byte;
    EXPECT_FALSE(read.damage[0].truncated);
  }
  ThreeEvents
      small;  // too small: the event is shortened, and its remaining bytes are a damaged part
  small.bytes[ThreeEvents::kSecond + 27] = 2;
  EXPECT_THAT(small.Read().data(), ElementsAre("first", "se", "third"));
}

TEST(LogReader, RandomBytesAreOneDamagedPart) {
  const TempFolder folder;
  folder.Write("log", std::string(100000, 'x'));
  const Contents read = ReadAll(folder / "log");
  EXPECT_THAT(read.events, IsEmpty());
  ASSERT_EQ(read.damage.size(), 1u);
  EXPECT_EQ(read.damage[0].bytes, 100000u);
}

// A file made to cost time: every head announces the largest size, and the events overlap.
TEST(LogReader, MaliciousHeadsCostLinearTime) {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 20000; ++i) {
    for (const int byte : {0xed, 0xa1, 0xda, 0x01}) bytes.push_back(static_cast<uint8_t>(byte));
    bytes.resize(bytes.size() + 16, 0);
    const std::vector<uint8_t> sizes{0, 0, 0, 1, 0, 0, 0x40, 0, 'C'};
    bytes.insert(bytes.end(), sizes.begin(), sizes.end());
  }
  const TempFolder folder;
  folder.Write("log", std::span<const uint8_t>(bytes));
  const Contents read = ReadAll(folder / "log");
  EXPECT_GT(read.damage.size(), 10000u);
}

TEST(LogReader, ErrorNamesTheFile) {
  const TempFolder folder;
  EXPECT_THAT(LogReader::Open(folder / "missing.lcmlog").error().message,
              HasSubstr("missing.lcmlog"));
  EXPECT_THAT(LogReader::Open(folder.path()).error().message, HasSubstr("expected a log"));
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(LogReader::Open(folder / "pipe").error().message, HasSubstr("expected a log"));
}

// Nothing may crash, and every byte of the file must belong to an event or a damaged part.
TEST(LogReader, NoMutatedLogCrashesIt) {
  LogBuilder builder;
  builder.Frame(1000).Detections(1000).Commit(1000, 1).Frame(2000).Commit(2000, 2);
  const std::vector<uint8_t> good = *ReadFileBytes(builder.Finish());
  const TempFolder folder;
  ForEachMutation(good, 4000, [&](const std::vector<uint8_t>& bad) {
    std::filesystem::remove(folder / "log");  // rewriting a file is slow on some file systems
    folder.Write("log", std::span<const uint8_t>(bad));
    const Contents read = ReadAll(folder / "log");
    uint64_t bytes = 0;
    for (const LogEvent& event : read.events) bytes += event.end() - event.offset;
    for (const LogDamage& damage : read.damage) bytes += damage.bytes;
    ASSERT_EQ(bytes, bad.size());
  });
}

TEST(LogWriter, WritesTheFileOnlyInFinish) {
  const TempFolder folder;
  {
    auto writer = LogWriter::Create(folder / "log");
    ASSERT_TRUE(writer);
    writer->Add(1, "CHAN", Bytes("first"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_THAT(LogWriter::Create(folder / "missing/log").error().message, HasSubstr("missing/log"));
}

}  // namespace
}  // namespace vismap
