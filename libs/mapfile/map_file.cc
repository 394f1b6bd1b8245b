#include "mapfile/map_file.h"

#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <memory>

#include "base/file.h"
#include "base/parallel.h"
#include "map.pb.h"
#include "mapfile/block_chunk.h"
#include "mapfile/expansion.h"
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
constexpr size_t kBytesPerMegabyte = size_t{1} << 20;

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
    chunk.set_thin(mapfile::EncodeThin(voxels, parts[i]));
    chunks[i] = chunk.SerializeAsString();
  });
  return chunks;
}

// A chunk is in memory as it is in the file, expanded, and as blocks, so only so many are at once.
constexpr size_t kChunksAtOnce = 16;
// Blocks near surfaces that stay unpacked. The others are packed at once, as they are in a map that
// was made here, so that a large map needs no more memory than when it was saved.
constexpr size_t kUnpackedSurfaces = 8000;

Result<std::vector<IndexedBlock>> DecodeChunk(const Record& record, size_t labels, bool pack) {
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
  auto blocks = mapfile::DecodeBlocks(raw, chunk.blocks(), labels);
  if (blocks) {
    if (const auto thin = mapfile::DecodeThin(AsBytes(chunk.thin()), &*blocks); !thin)
      return tl::unexpected(thin.error());
  }
  if (blocks && pack) {
    for (IndexedBlock& entry : *blocks) entry.second.surface.Pack();
  }
  return blocks;
}

/// Adds the blocks of decoded chunks to a map, in ascending order and within a limit.
class BlockInserter {
 public:
  BlockInserter(size_t max_bytes, VoxelMap* voxels) : max_bytes_(max_bytes), voxels_(*voxels) {}

  bool has_many_surfaces() const { return surfaces_ >= kUnpackedSurfaces; }

  Result<void> Add(std::vector<IndexedBlock> blocks) {
    for (auto& [index, block] : blocks) {
      if (!(last_ < index)) return Fail("blocks are not in ascending order");
      last_ = index;
      surfaces_ += static_cast<bool>(block.surface);
      voxels_.CountBytes(0, BytesOf(block));
      voxels_.FindOrCreate(index) = std::move(block);
      if (voxels_.bytes() > max_bytes_) {
        return Fail("the map needs more than the allowed " +
                    std::to_string(max_bytes_ / kBytesPerMegabyte) +
                    " MB of memory (integration.max_map_mb)");
      }
    }
    return {};
  }

 private:
  size_t max_bytes_;
  VoxelMap& voxels_;
  BlockIndex last_{INT32_MIN, INT32_MIN, INT32_MIN};
  size_t surfaces_ = 0;
};

Result<void> DecodeChunks(std::span<const Record> records, size_t labels, size_t max_bytes,
                          VoxelMap* voxels) {
  BlockInserter inserter(max_bytes, voxels);
  for (size_t first = 0; first < records.size(); first += kChunksAtOnce) {
    const size_t count = std::min(kChunksAtOnce, records.size() - first);
    std::vector<Result<std::vector<IndexedBlock>>> chunks(count);
    const bool pack = inserter.has_many_surfaces();
    ParallelFor(count, 1,
                [&](size_t i) { chunks[i] = DecodeChunk(records[first + i], labels, pack); });
    for (size_t i = 0; i < count; ++i) {
      const Result<void> added =
          chunks[i] ? inserter.Add(std::move(*chunks[i])) : tl::unexpected(chunks[i].error());
      if (!added) {
        return Fail("chunk " + std::to_string(first + i + 1) +
                    " of blocks: " + added.error().message);
      }
    }
  }
  return {};
}

// Header and labels expand when they are read. Each may take half of the limit.
Result<void> CheckExpansion(const Record& record, size_t max_bytes) {
  const size_t bytes = mapfile::ExpandedBytes(record.content);
  if (bytes <= max_bytes / 2) return {};
  return Fail("a record of " + std::to_string(record.content.size()) + " bytes would need up to " +
              std::to_string(bytes / kBytesPerMegabyte) +
              " MB of memory, more than half of the allowed " +
              std::to_string(max_bytes / kBytesPerMegabyte) + " MB (integration.max_map_mb)");
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

Result<LoadedMap> DecodeRecords(std::span<const uint8_t> bytes, size_t max_bytes) {
  const Result<std::vector<Record>> records = mapfile::SplitRecords(bytes);
  if (!records) return tl::unexpected(records.error());
  if (Result<void> order = CheckOrder(*records); !order) return tl::unexpected(order.error());
  for (size_t i = 0; i < 2; ++i) {
    if (Result<void> checked = CheckExpansion((*records)[i], max_bytes); !checked)
      return tl::unexpected(checked.error());
  }
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
          DecodeChunks(chunks, loaded->map.labels.records().size(), max_bytes, &loaded->map.voxels);
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

Result<LoadedMap> DecodeMap(std::span<const uint8_t> bytes, const std::string& name,
                            size_t max_bytes) {
  Result<LoadedMap> loaded = DecodeRecords(bytes, max_bytes);
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

Result<LoadedMap> LoadMap(const std::filesystem::path& path, size_t max_bytes) {
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, max_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return DecodeMap(*bytes, path.string(), max_bytes);
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
      !CheckExpansion(records->front(), kDefaultMaxMapBytes) ||
      !ParseMessage(records->front().content, &header)) {
    return Fail(path.string() + ": the header cannot be read");
  }
  return header.revision();
}

}  // namespace vismap
