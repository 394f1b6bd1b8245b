#include "mcap/mcap_writer.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "base/require.h"
#include "codecs/zstd_codec.h"

namespace vismap {
namespace {

constexpr std::array<uint8_t, 8> kMcapMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Op : uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

using Content = std::vector<uint8_t>;

template <typename Number>
void Put(Number value, Content* out) {
  for (size_t i = 0; i < sizeof(Number); ++i)
    out->push_back(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
}

void PutBytes(std::string_view bytes, Content* out) {
  out->insert(out->end(), bytes.begin(), bytes.end());
}

void PutText(std::string_view text, Content* out) {
  Put(static_cast<uint32_t>(text.size()), out);
  PutBytes(text, out);
}

void PutRecord(Op op, const Content& content, Content* out) {
  out->push_back(static_cast<uint8_t>(op));
  Put(static_cast<uint64_t>(content.size()), out);
  out->insert(out->end(), content.begin(), content.end());
}

Content RecordOf(Op op, const Content& content) {
  Content record;
  PutRecord(op, content, &record);
  return record;
}

void PutCounts(const std::map<uint16_t, uint64_t>& counts, Content* out) {
  Put(static_cast<uint32_t>(counts.size() * 10), out);
  for (const auto& [channel, count] : counts) {
    Put(channel, out);
    Put(count, out);
  }
}

uint32_t ExtendCrc(uint32_t crc, std::span<const uint8_t> bytes) {
  return static_cast<uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

// A group of records of the summary, and where it stands.
struct SummaryGroup {
  Op op;
  uint64_t start = 0, length = 0;
};

}  // namespace

void McapWriter::TimeRange::Extend(uint64_t time, bool is_first) {
  first = is_first ? time : std::min(first, time);
  last = is_first ? time : std::max(last, time);
}

McapWriter::McapWriter(PartFile file, const McapOptions& options)
    : file_(std::move(file)), options_(options) {
  WriteOut(kMcapMagic);
  Content header;
  PutText("", &header);  // no profile
  PutText("vismap", &header);
  WriteOut(RecordOf(Op::kHeader, header));
}

Result<McapWriter> McapWriter::Create(const std::filesystem::path& path,
                                      const McapOptions& options) {
  Result<PartFile> file = PartFile::Create(path);
  if (!file) return tl::unexpected(file.error());
  return McapWriter(std::move(*file), options);
}

void McapWriter::WriteOut(std::span<const uint8_t> bytes) {
  file_.Write(bytes);
  crc_ = ExtendCrc(crc_, bytes);
  position_ += bytes.size();
}

uint16_t McapWriter::AddSchema(const std::string& name, const std::string& encoding,
                               std::string_view data) {
  Require(schemas_.size() < 65535, "an MCAP file has at most 65535 schemas");
  const auto id = static_cast<uint16_t>(schemas_.size() + 1);
  Content content;
  Put(id, &content);
  PutText(name, &content);
  PutText(encoding, &content);
  PutText(data, &content);
  schemas_.push_back(RecordOf(Op::kSchema, content));
  chunk_.insert(chunk_.end(), schemas_.back().begin(), schemas_.back().end());
  return id;
}

uint16_t McapWriter::AddChannel(const std::string& topic, const std::string& message_encoding,
                                uint16_t schema) {
  Require(channels_.size() < 65536, "an MCAP file has at most 65536 channels");
  Require(schema <= schemas_.size(), "the schema of a channel was added before");
  const auto id = static_cast<uint16_t>(channels_.size());
  Content content;
  Put(id, &content);
  Put(schema, &content);
  PutText(topic, &content);
  PutText(message_encoding, &content);
  Put(uint32_t{0}, &content);  // no metadata
  channels_.push_back({RecordOf(Op::kChannel, content), 0, {}});
  const Bytes& record = channels_.back().record;
  chunk_.insert(chunk_.end(), record.begin(), record.end());
  return id;
}

void McapWriter::AddMessage(uint16_t channel, const McapTimes& times, std::string_view data) {
  Require(channel < channels_.size(), "the channel of a message was added before");
  ChannelState& state = channels_[channel];
  state.in_chunk.emplace_back(times.log_ns, chunk_.size());
  chunk_.push_back(static_cast<uint8_t>(Op::kMessage));
  Put(uint64_t{22} + data.size(), &chunk_);
  Put(channel, &chunk_);
  Put(static_cast<uint32_t>(state.messages++), &chunk_);
  Put(times.log_ns, &chunk_);
  Put(times.publish_ns, &chunk_);
  PutBytes(data, &chunk_);
  chunk_times_.Extend(times.log_ns, chunk_messages_++ == 0);
  all_times_.Extend(times.log_ns, messages_++ == 0);
  if (chunk_.size() >= options_.chunk_bytes) EndChunk();
}

// Writes an index for each channel that has messages in the chunk; returns where each stands.
std::map<uint16_t, uint64_t> McapWriter::WriteMessageIndexes() {
  std::map<uint16_t, uint64_t> offsets;
  for (size_t channel = 0; channel < channels_.size(); ++channel) {
    auto& entries = channels_[channel].in_chunk;
    if (entries.empty()) continue;
    const auto id = static_cast<uint16_t>(channel);
    Content content;
    Put(id, &content);
    Put(static_cast<uint32_t>(entries.size() * 16), &content);
    for (const auto& [time, offset] : entries) {
      Put(time, &content);
      Put(offset, &content);
    }
    offsets.emplace(id, position_);
    WriteOut(RecordOf(Op::kMessageIndex, content));
    entries.clear();
  }
  return offsets;
}

void McapWriter::EndChunk() {
  if (chunk_.empty()) return;
  Bytes packed = options_.compress ? CompressBytes(chunk_) : Bytes{};
  const bool compressed = options_.compress && packed.size() < chunk_.size();
  const Bytes& records = compressed ? packed : chunk_;
  const std::string compression = compressed ? "zstd" : "";
  const uint64_t start = position_;
  Content head;
  Put(chunk_times_.first, &head);
  Put(chunk_times_.last, &head);
  Put(static_cast<uint64_t>(chunk_.size()), &head);
  Put(ExtendCrc(0, chunk_), &head);
  PutText(compression, &head);
  Put(static_cast<uint64_t>(records.size()), &head);
  Content opening{static_cast<uint8_t>(Op::kChunk)};
  Put(static_cast<uint64_t>(head.size() + records.size()), &opening);
  WriteOut(opening);
  WriteOut(head);
  WriteOut(records);
  const uint64_t end = position_;

  Content index;
  Put(chunk_times_.first, &index);
  Put(chunk_times_.last, &index);
  Put(start, &index);
  Put(end - start, &index);
  PutCounts(WriteMessageIndexes(), &index);
  Put(position_ - end, &index);
  PutText(compression, &index);
  Put(static_cast<uint64_t>(records.size()), &index);
  Put(static_cast<uint64_t>(chunk_.size()), &index);
  chunk_indexes_.push_back(RecordOf(Op::kChunkIndex, index));
  chunk_.clear();
  chunk_messages_ = 0;
  chunk_times_ = {};
}

McapWriter::Bytes McapWriter::Statistics() const {
  Content content;
  Put(messages_, &content);
  Put(static_cast<uint16_t>(schemas_.size()), &content);
  Put(static_cast<uint32_t>(channels_.size()), &content);
  Put(uint32_t{0}, &content);  // attachments
  Put(uint32_t{0}, &content);  // metadata
  Put(static_cast<uint32_t>(chunk_indexes_.size()), &content);
  Put(all_times_.first, &content);
  Put(all_times_.last, &content);
  std::map<uint16_t, uint64_t> counts;
  for (size_t i = 0; i < channels_.size(); ++i)
    counts.emplace(static_cast<uint16_t>(i), channels_[i].messages);
  PutCounts(counts, &content);
  return RecordOf(Op::kStatistics, content);
}

// The summary, its offsets and the footer, up to the checksum that ends the footer.
McapWriter::Bytes McapWriter::Summary() const {
  Content summary;
  std::vector<SummaryGroup> groups;
  const auto add_group = [&](Op op, const auto& records) {
    const size_t start = summary.size();
    for (const Bytes& record : records) summary.insert(summary.end(), record.begin(), record.end());
    if (summary.size() > start) groups.push_back({op, position_ + start, summary.size() - start});
  };
  std::vector<Bytes> channels;
  for (const ChannelState& channel : channels_) channels.push_back(channel.record);
  add_group(Op::kSchema, schemas_);
  add_group(Op::kChannel, channels);
  add_group(Op::kStatistics, std::array{Statistics()});
  add_group(Op::kChunkIndex, chunk_indexes_);

  const uint64_t offsets_start = position_ + summary.size();
  for (const SummaryGroup& group : groups) {
    Content content{static_cast<uint8_t>(group.op)};
    Put(group.start, &content);
    Put(group.length, &content);
    PutRecord(Op::kSummaryOffset, content, &summary);
  }
  summary.push_back(static_cast<uint8_t>(Op::kFooter));
  Put(uint64_t{20}, &summary);
  Put(position_, &summary);
  Put(offsets_start, &summary);
  return summary;
}

Result<void> McapWriter::Finish() {
  EndChunk();
  Content data_end;
  Put(crc_, &data_end);
  WriteOut(RecordOf(Op::kDataEnd, data_end));
  Bytes summary = Summary();
  Put(ExtendCrc(0, summary), &summary);
  WriteOut(summary);
  WriteOut(kMcapMagic);
  return file_.Finish();
}

}  // namespace vismap
