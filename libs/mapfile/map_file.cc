#include "mapfile/map_file.h"

#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "base/file.h"
#include "base/parallel.h"
#include "map.pb.h"
#include "mapfile/block_chunk.h"
#include "mapfile/map_proto.h"
#include "mapfile/record_stream.h"

namespace vismap {
namespace {

using mapfile::IndexedBlock;
using mapfile::Record;
using mapfile::RecordKind;

// Level -3 takes two thirds of the time of level 1 and gives a seventh more bytes.
constexpr int kZstdLevel = -3;
// More than any chunk has: it ends with the block that passes half a megabyte.
constexpr size_t kMaxChunkBytes = size_t{1} << 22;

std::span<const uint8_t> AsBytes(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

template <typename Message>
void AppendMessage(RecordKind kind, const Message& message, std::vector<uint8_t>* file) {
  mapfile::AppendRecord(kind, AsBytes(message.SerializeAsString()), file);
}

template <typename Message>
bool ParseMessage(std::span<const uint8_t> content, Message* message) {
  return message->ParseFromArray(content.data(), static_cast<int>(content.size()));
}

std::string Compress(const std::vector<uint8_t>& raw) {
  std::string packed(ZSTD_compressBound(raw.size()), '\0');
  const size_t size =
      ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), kZstdLevel);
  Require(!ZSTD_isError(size), "zstd compresses into a buffer of its own bound");
  packed.resize(size);
  return packed;
}

/// The serialised chunks of all blocks, made in parallel. Their limits do not depend on the number
/// of threads.
std::vector<std::string> EncodeChunks(const VoxelMap& voxels) {
  const std::vector<BlockIndex> indices = voxels.SortedIndices();
  std::vector<std::span<const BlockIndex>> parts;
  for (std::span<const BlockIndex> rest = indices; !rest.empty();) {
    const size_t length = mapfile::ChunkLength(voxels, rest);
    parts.push_back(rest.first(length));
    rest = rest.subspan(length);
  }
  std::vector<std::string> chunks(parts.size());
  ParallelFor(parts.size(), 1, [&](size_t i) {
    const std::vector<uint8_t> raw = mapfile::EncodeBlocks(voxels, parts[i]);
    mapfile::BlockChunk chunk;
    chunk.set_blocks(static_cast<uint32_t>(parts[i].size()));
    chunk.set_raw_bytes(static_cast<uint32_t>(raw.size()));
    chunk.set_zstd(Compress(raw));
    chunks[i] = chunk.SerializeAsString();
  });
  return chunks;
}

Result<std::vector<IndexedBlock>> DecodeChunk(const Record& record, size_t labels) {
  mapfile::BlockChunk chunk;
  if (!ParseMessage(record.content, &chunk)) return Fail("it cannot be read");
  if (chunk.raw_bytes() > kMaxChunkBytes) {
    return Fail("its stated size is " + std::to_string(chunk.raw_bytes()) +
                " bytes, more than any chunk has");
  }
  std::vector<uint8_t> raw(chunk.raw_bytes());
  const size_t size =
      ZSTD_decompress(raw.data(), raw.size(), chunk.zstd().data(), chunk.zstd().size());
  if (ZSTD_isError(size))
    return Fail(std::string("zstd cannot decompress it: ") + ZSTD_getErrorName(size));
  if (size != raw.size()) return Fail("it does not have its stated size");
  return mapfile::DecodeBlocks(raw, chunk.blocks(), labels);
}

Result<void> DecodeChunks(std::span<const Record> records, size_t labels, VoxelMap* voxels) {
  std::vector<Result<std::vector<IndexedBlock>>> chunks(records.size());
  ParallelFor(records.size(), 1, [&](size_t i) { chunks[i] = DecodeChunk(records[i], labels); });
  const BlockIndex* last = nullptr;
  for (size_t i = 0; i < chunks.size(); ++i) {
    const std::string place = "chunk " + std::to_string(i + 1) + " of blocks: ";
    if (!chunks[i]) return Fail(place + chunks[i].error().message);
    for (const IndexedBlock& entry : *chunks[i]) {
      if (last != nullptr && !(*last < entry.first))
        return Fail(place + "blocks are not in ascending order");
      last = &entry.first;
    }
  }
  for (Result<std::vector<IndexedBlock>>& chunk : chunks) {
    for (auto& [index, block] : *chunk) voxels->FindOrCreate(index) = std::move(block);
  }
  return {};
}

/// Checks that the records are header, labels, chunks and end, in this order.
Result<void> CheckOrder(const std::vector<Record>& records) {
  if (records.size() < 2 || records[0].kind != RecordKind::kHeader ||
      records[1].kind != RecordKind::kLabels) {
    return Fail("expected a header and the labels at the start");
  }
  if (records.back().kind != RecordKind::kEnd) {
    return Fail("expected an end record after " + std::to_string(records.size()) +
                " records: the file is cut");
  }
  for (size_t i = 2; i + 1 < records.size(); ++i) {
    if (records[i].kind != RecordKind::kBlocks) {
      return Fail("record " + std::to_string(i + 1) + " is not a chunk of blocks");
    }
  }
  return {};
}

Result<void> CheckEnd(const Record& record, LoadedMap* loaded) {
  mapfile::End end;
  if (!ParseMessage(record.content, &end)) return Fail("the end record cannot be read");
  if (end.blocks() != loaded->map.voxels.size() ||
      end.labels() != loaded->map.labels.records().size()) {
    return Fail("the end record promises " + std::to_string(end.blocks()) + " blocks and " +
                std::to_string(end.labels()) + " labels, found " +
                std::to_string(loaded->map.voxels.size()) + " and " +
                std::to_string(loaded->map.labels.records().size()));
  }
  loaded->map_hash = HashMap(loaded->map);
  if (end.map_hash() != loaded->map_hash) {
    return Fail("expected the map hash " + end.map_hash() + ", found " + loaded->map_hash);
  }
  return {};
}

Result<LoadedMap> DecodeRecords(std::span<const uint8_t> bytes) {
  const Result<std::vector<Record>> records = mapfile::SplitRecords(bytes);
  if (!records) return tl::unexpected(records.error());
  if (Result<void> order = CheckOrder(*records); !order) return tl::unexpected(order.error());
  mapfile::Header header;
  mapfile::Labels proto_labels;
  if (!ParseMessage((*records)[0].content, &header)) return Fail("the header cannot be read");
  if (!ParseMessage((*records)[1].content, &proto_labels)) {
    return Fail("the labels cannot be read");
  }
  Result<LoadedMap> loaded = mapfile::FromProto(header);
  if (!loaded) return loaded;
  Result<LabelTable> labels = mapfile::FromProto(proto_labels);
  if (!labels) return tl::unexpected(labels.error());
  loaded->map.labels = std::move(*labels);
  const std::span<const Record> chunks(records->data() + 2, records->size() - 3);
  if (Result<void> decoded =
          DecodeChunks(chunks, loaded->map.labels.records().size(), &loaded->map.voxels);
      !decoded) {
    return tl::unexpected(decoded.error());
  }
  if (Result<void> end = CheckEnd(records->back(), &*loaded); !end) {
    return tl::unexpected(end.error());
  }
  return loaded;
}

/// `map_hash`: of the map, for the end record.
std::vector<uint8_t> EncodeRecords(const SemanticMap& map, const MapMetadata& metadata,
                                   const std::string& map_hash) {
  std::vector<uint8_t> file = mapfile::FilePrefix();
  mapfile::Header header;
  mapfile::ToProto(map, metadata, &header);
  AppendMessage(RecordKind::kHeader, header, &file);
  mapfile::Labels labels;
  mapfile::ToProto(map.labels, &labels);
  AppendMessage(RecordKind::kLabels, labels, &file);
  std::vector<std::string> chunks = EncodeChunks(map.voxels);
  size_t total = file.size() + 256;
  for (const std::string& chunk : chunks) total += chunk.size() + 64;
  file.reserve(total);
  for (std::string& chunk : chunks) {
    mapfile::AppendRecord(RecordKind::kBlocks, AsBytes(chunk), &file);
    chunk = {};  // frees it, so that the compressed map is not in memory twice
  }
  mapfile::End end;
  end.set_blocks(map.voxels.size());
  end.set_labels(map.labels.records().size());
  end.set_map_hash(map_hash);
  AppendMessage(RecordKind::kEnd, end, &file);
  return file;
}

}  // namespace

std::vector<uint8_t> EncodeMap(const SemanticMap& map, const MapMetadata& metadata) {
  return EncodeRecords(map, metadata, HashMap(map));
}

Result<LoadedMap> DecodeMap(std::span<const uint8_t> bytes, const std::string& name) {
  Result<LoadedMap> loaded = DecodeRecords(bytes);
  if (!loaded) return Fail(name + ": " + loaded.error().message);
  return loaded;
}

Result<SaveInfo> SaveMap(const SemanticMap& map, const MapMetadata& metadata,
                         const std::filesystem::path& path,
                         const std::vector<std::filesystem::path>& keep_old_as) {
  const std::string map_hash = HashMap(map);
  const std::vector<uint8_t> bytes = EncodeRecords(map, metadata, map_hash);
  if (Result<void> written = WriteFileAndKeepOld(path, bytes, keep_old_as); !written) {
    return tl::unexpected(written.error());
  }
  std::error_code ignored;
  return SaveInfo{std::filesystem::absolute(path, ignored), bytes.size(), map_hash};
}

Result<LoadedMap> LoadMap(const std::filesystem::path& path) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return DecodeMap(*bytes, path.string());
}

Result<int64_t> FramesOfMapFile(const std::filesystem::path& path) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);  // fails unless it is regular
  std::ifstream file(error ? std::filesystem::path() : path, std::ios::binary);
  const auto read_until = [&](uint64_t end, std::vector<uint8_t>* start) {
    const size_t before = start->size();
    start->resize(std::min(end, size));
    file.read(reinterpret_cast<char*>(start->data()) + before,
              static_cast<std::streamsize>(start->size() - before));
  };
  std::vector<uint8_t> start;
  if (file) read_until(mapfile::kFirstRecordAt, &start);
  if (file) read_until(mapfile::EndOfFirstRecord(start), &start);
  if (!file) return Fail(path.string() + ": cannot be read");
  const Result<std::vector<Record>> records = mapfile::SplitRecords(start);
  mapfile::Header header;
  if (!records) return Fail(path.string() + ": " + records.error().message);
  if (records->empty() || records->front().kind != RecordKind::kHeader ||
      !ParseMessage(records->front().content, &header)) {
    return Fail(path.string() + ": the header cannot be read");
  }
  return header.revision();
}

}  // namespace vismap
