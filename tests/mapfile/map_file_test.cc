#include "mapfile/map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/file.h"
#include "base/parallel.h"
#include "mapfile/block_chunk.h"
#include "mapfile/record_stream.h"
#include "mapping/integrate.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

uint64_t Next(uint64_t* state) {
  uint64_t z = *state += 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

std::unique_ptr<SurfaceVoxels> RandomVoxels(uint64_t* state, uint32_t labels) {
  auto voxels = std::make_unique<SurfaceVoxels>();
  for (uint32_t i = 0; i < 1 + Next(state) % 5; ++i) {
    voxels->palette.push_back(static_cast<SegmentLabel>(1 + Next(state) % labels));
  }
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    const uint64_t r = Next(state);
    voxels->distance[i] = static_cast<int16_t>(r);
    voxels->weight[i] = static_cast<uint16_t>(r >> 16);
    voxels->observations[i] = static_cast<uint8_t>(r >> 32);
    voxels->color[i] = {static_cast<uint8_t>(r >> 40), static_cast<uint8_t>(r >> 48), 7};
    voxels->slot_label[i][0] = static_cast<uint8_t>(Next(state) % (voxels->palette.size() + 1));
    voxels->slot_votes[i][0] = static_cast<uint8_t>(r >> 56);
  }
  return voxels;
}

/// A map with every kind of block, merged labels, pairs, and evidence with all digits of a float.
SemanticMap RandomMap(uint64_t seed, int blocks) {
  SemanticMap map(VoxelGridOptions{0.013, 4.5});
  uint64_t state = seed;
  map.labels.GrowLabels(SegmentLabel{40});
  map.labels.GrowInstances(InstanceId{9});
  for (uint32_t label = 1; label < 40; ++label) {
    LabelRecord& record = map.labels.MutableRecord(SegmentLabel{label});
    record.frames = static_cast<uint32_t>(Next(&state));
    record.frames_with_detector = static_cast<uint32_t>(Next(&state));
    record.pixels = Next(&state);
    record.first_utime = -static_cast<int64_t>(Next(&state) >> 1);
    record.last_utime = static_cast<int64_t>(Next(&state) >> 1);
    record.cleared_voxels = static_cast<uint32_t>(Next(&state) % 3);
    if (record.cleared_voxels > 0) record.cleared_utime = static_cast<int64_t>(Next(&state) >> 1);
    record.instance_evidence[InstanceId{1 + label % 8}] = static_cast<float>(label) / 7;
    record.instance_evidence[InstanceId{9}] = std::numeric_limits<float>::denorm_min();
    record.class_evidence[ClassId{65535}] = 1e30F;
  }
  map.labels.MutablePair(SegmentLabel{3}, SegmentLabel{30}) = {0.1F, 0.3F};
  map.labels.MutablePair(SegmentLabel{30}, SegmentLabel{7}) = {1.7F, 0};
  const std::vector<MaskedLabel> masked{{SegmentLabel{3}, DetectionIndex{0}, 0.3F},
                                        {SegmentLabel{12}, DetectionIndex{0}, 0.7F},
                                        {SegmentLabel{30}, DetectionIndex{0}, 0.1F}};
  map.labels.MutableBonds().AddFrame(masked);
  map.labels.Merge(SegmentLabel{12}, SegmentLabel{5});
  map.labels.Merge(SegmentLabel{5}, SegmentLabel{3});
  map.labels.min_instance_ratio = 0.23F;
  for (int i = 0; i < blocks; ++i) {
    const uint64_t r = Next(&state);
    const BlockIndex index{static_cast<int32_t>(r % 100) - 50,
                           static_cast<int32_t>(r / 100 % 100) - 50,
                           static_cast<int32_t>(r / 10000 % 20) - 10};
    Block& block = map.voxels.FindOrCreate(index);
    block = Block{};
    if (i % 4 == 0) block.surface = RandomVoxels(&state, 39);
    if (i % 4 == 1) block.all_free = true;
    if (i % 4 == 2) {
      block.free = std::make_unique<FreeVoxels>();
      for (size_t word = 0; word < 8; ++word) {
        block.free->once[word] = Next(&state);
        block.free->twice[word] = block.free->once[word] & Next(&state);
      }
    }
    if (i % 7 == 0) {
      block.thin = std::make_unique<ThinVoxels>();
      for (int voxel = 0; voxel < 9; ++voxel)
        block.thin->hits[Next(&state) % kBlockVoxels] = static_cast<uint8_t>(1 + voxel);
    }
  }
  map.revision = 41;
  map.last_utime = 1234567890123;
  map.last_camera_W = {0.1, -2.3, 1e-17};
  return map;
}

MapMetadata SomeMetadata() {
  MapMetadata metadata;
  metadata.map_id = "map-7";
  metadata.config = "integration { max_range_m: 3 }  # \xc3\xa4\n";
  metadata.created_by = "vismap 0.1.0";
  metadata.class_names = {{ClassId{1}, "person"}, {ClassId{62}, "chair"}};
  for (int i = 0; i < 3; ++i) {
    CameraPose pose;
    pose.utime = 1000 * i;
    pose.camera_id = CameraId{i - 1};
    pose.T_W_C.linear() = Eigen::AngleAxisd(0.3 * i, Eigen::Vector3d::UnitY()).matrix();
    pose.T_W_C.translation() = Eigen::Vector3d(1.0 / 3, -i, 0);
    metadata.trajectory.push_back(pose);
  }
  return metadata;
}

bool SameVoxels(const Block& a, const Block& b) {
  if (a.all_free != b.all_free || !a.surface != !b.surface || !a.free != !b.free) return false;
  if (a.free && !(*a.free == *b.free)) return false;
  if (!a.thin != !b.thin || (a.thin && !(*a.thin == *b.thin))) return false;
  if (!a.surface) return true;
  const SurfaceVoxels& x = *a.surface;
  const SurfaceVoxels& y = *b.surface;
  return x.distance == y.distance && x.weight == y.weight && x.observations == y.observations &&
         x.color == y.color && x.slot_label == y.slot_label && x.slot_votes == y.slot_votes &&
         x.palette == y.palette;
}

void ExpectSameMap(const SemanticMap& a, const SemanticMap& b) {
  EXPECT_EQ(a.voxels.options().voxel_size_m, b.voxels.options().voxel_size_m);
  EXPECT_EQ(a.voxels.options().truncation_voxels, b.voxels.options().truncation_voxels);
  EXPECT_EQ(a.labels, b.labels);
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.last_utime, b.last_utime);
  EXPECT_EQ(a.last_camera_W, b.last_camera_W);
  ASSERT_EQ(a.voxels.SortedIndices(), b.voxels.SortedIndices());
  for (const BlockIndex index : a.voxels.SortedIndices()) {
    ASSERT_TRUE(SameVoxels(*a.voxels.Find(index), *b.voxels.Find(index)));
  }
  EXPECT_EQ(HashMap(a), HashMap(b));
}

TEST(MapFile, RoundTripKeepsEverything) {
  for (const int blocks : {0, 1, 7, 900}) {
    const SemanticMap map = RandomMap(static_cast<uint64_t>(blocks), blocks);
    const MapMetadata metadata = SomeMetadata();
    const Result<LoadedMap> loaded = DecodeMap(EncodeMap(map, metadata), "map");
    ASSERT_TRUE(loaded) << loaded.error().message;
    ExpectSameMap(loaded->map, map);
    EXPECT_EQ(loaded->map_hash, HashMap(map));
    EXPECT_EQ(loaded->metadata.map_id, metadata.map_id);
    EXPECT_EQ(loaded->metadata.config, metadata.config);
    EXPECT_EQ(loaded->metadata.created_by, metadata.created_by);
    EXPECT_EQ(loaded->metadata.class_names, metadata.class_names);
    ASSERT_EQ(loaded->metadata.trajectory.size(), metadata.trajectory.size());
    for (size_t i = 0; i < metadata.trajectory.size(); ++i) {
      EXPECT_EQ(loaded->metadata.trajectory[i].utime, metadata.trajectory[i].utime);
      EXPECT_EQ(loaded->metadata.trajectory[i].camera_id, metadata.trajectory[i].camera_id);
      EXPECT_EQ(loaded->metadata.trajectory[i].T_W_C.matrix(),
                metadata.trajectory[i].T_W_C.matrix());
    }
  }
}

TEST(MapFile, TheSameMapGivesTheSameBytesWhateverItsHistoryAndThreads) {
  const SemanticMap map = RandomMap(3, 700);
  const std::vector<uint8_t> bytes = EncodeMap(map, SomeMetadata());
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    EXPECT_EQ(EncodeMap(map, SomeMetadata()), bytes);
    const Result<LoadedMap> loaded = DecodeMap(bytes, "map");
    ASSERT_TRUE(loaded);
    EXPECT_EQ(EncodeMap(loaded->map, loaded->metadata), bytes);
  }
}

/// A wall seen head on, in two segments.
SegmentedFrame WallFrame(int number) {
  SegmentedFrame frame;
  frame.frame.header.utime = 1000 * (number + 1);
  frame.frame.header.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.frame.header.T_W_C.translation() = Eigen::Vector3d(0.02 * number, 0, 0);
  frame.frame.depth = Image<float>(64, 48, 1.0F + 0.003F * static_cast<float>(number));
  frame.frame.color = Image<Rgb8>(64, 48, Rgb8{90, 80, static_cast<uint8_t>(number)});
  frame.image.index = Image<SegmentIndex>(64, 48, SegmentIndex{0});
  for (int v = 0; v < 48; ++v) {
    for (int u = 32; u < 64; ++u) frame.image.index(v, u) = SegmentIndex{1};
  }
  frame.image.segment_count = 2;
  frame.segments.resize(2);
  frame.segments[0].pixels = frame.segments[1].pixels = 32 * 48;
  frame.segments[1].detection = DetectionIndex{0};
  frame.segments[1].class_id = ClassId{62};
  frame.segments[1].score = 0.9F;
  frame.segments[1].overlap = 0.95F;
  frame.had_detections = true;
  return frame;
}

void Integrate(int number, SemanticMap* map) {
  const SegmentedFrame frame = WallFrame(number);
  const FrameAssociation association = Associate(frame, {map->voxels, map->labels}, {});
  IntegrateFrame(frame, association, {}, map);
}

TEST(MapFile, LoadedMapGoesOnExactlyAsTheSavedOneWouldHave) {
  SemanticMap map(VoxelGridOptions{0.02, 4.0});
  for (int number = 0; number < 4; ++number) Integrate(number, &map);
  Result<LoadedMap> loaded = DecodeMap(EncodeMap(map, {}), "map");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_GT(map.voxels.size(), 100u);
  for (int number = 4; number < 8; ++number) {
    Integrate(number, &map);
    Integrate(number, &loaded->map);
    ASSERT_EQ(HashMap(map), HashMap(loaded->map)) << "after frame " << number;
  }
  ExpectSameMap(loaded->map, map);
}

TEST(MapFile, EveryCutIsAnError) {
  const std::vector<uint8_t> bytes = EncodeMap(RandomMap(1, 5), SomeMetadata());
  for (size_t size = 0; size < bytes.size(); ++size) {
    const Result<LoadedMap> loaded = DecodeMap(std::span(bytes.data(), size), "cut.vismap");
    ASSERT_FALSE(loaded) << "at " << size;
    ASSERT_THAT(loaded.error().message, HasSubstr("cut.vismap: "));
  }
  std::vector<uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(DecodeMap(longer, "longer"));
}

TEST(MapFile, EveryFlippedBitIsAnError) {
  const std::vector<uint8_t> bytes = EncodeMap(RandomMap(1, 5), SomeMetadata());
  for (size_t i = 0; i < 6000; ++i) {
    std::vector<uint8_t> flipped = bytes;
    const size_t at = i < 2000 ? i % bytes.size() : i * 7919 % bytes.size();
    flipped[at] ^= static_cast<uint8_t>(1 << (i % 8));
    ASSERT_FALSE(DecodeMap(flipped, "flipped")) << "bit " << i % 8 << " of byte " << at;
  }
}

/// The file with the content of one record replaced and a correct checksum.
std::vector<uint8_t> Rewrite(const std::vector<uint8_t>& bytes, size_t which,
                             const std::vector<uint8_t>& content) {
  const auto records = mapfile::SplitRecords(bytes);
  std::vector<uint8_t> file = mapfile::FilePrefix();
  for (size_t i = 0; i < records->size(); ++i) {
    mapfile::AppendRecord((*records)[i].kind, i == which ? content : (*records)[i].content, &file);
  }
  return file;
}

TEST(MapFile, DamageBehindRightChecksumsIsAnErrorNotACrash) {
  const std::vector<uint8_t> bytes = EncodeMap(RandomMap(1, 40), SomeMetadata());
  const auto records = mapfile::SplitRecords(bytes);
  ASSERT_TRUE(records);
  uint64_t state = 5;
  for (int i = 0; i < 1500; ++i) {
    const size_t which = Next(&state) % records->size();
    const auto& original = (*records)[which].content;
    std::vector<uint8_t> content(original.begin(), original.end());
    const size_t range = i % 2 == 0 ? content.size() : std::min<size_t>(content.size(), 40);
    content[Next(&state) % range] ^= static_cast<uint8_t>(1 << Next(&state) % 8);
    if (i % 5 == 0) content.resize(Next(&state) % content.size());
    const Result<LoadedMap> loaded = DecodeMap(Rewrite(bytes, which, content), "evil");
    if (!loaded) continue;
    EXPECT_EQ(loaded->map.voxels.size(), RandomMap(1, 40).voxels.size());
  }
}

/// A file that is small and right but for its hash, with `count` blocks of free space far from each
/// other: every one needs a cube of the table for itself.
std::vector<uint8_t> FileOfScatteredBlocks(int count) {
  SemanticMap map{VoxelGridOptions{}};
  for (int i = 0; i < count; ++i) map.voxels.FindOrCreate({i * 4, 0, 0}).all_free = true;
  return EncodeMap(map, {});
}

TEST(MapFile, AMapThatNeedsMoreMemoryThanAllowedIsRefused) {
  constexpr size_t kMegabyte = size_t{1} << 20;
  const std::vector<uint8_t> bytes = FileOfScatteredBlocks(50'000);
  EXPECT_LT(bytes.size(), 400'000u);
  const Result<LoadedMap> refused = DecodeMap(bytes, "bomb", 16 * kMegabyte);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("needs more than the allowed 16 MB"));
  const Result<LoadedMap> loaded = DecodeMap(bytes, "bomb", 256 * kMegabyte);
  ASSERT_TRUE(loaded);
  EXPECT_LE(MeasureMemory(loaded->map.voxels).total_bytes(), 256 * kMegabyte);
}

TEST(MapFile, ListsOfEmptyEntriesAreRefusedBeforeTheyAreRead) {
  const std::vector<uint8_t> bytes = EncodeMap(RandomMap(1, 5), SomeMetadata());
  constexpr size_t kEntries = 5'000'000;
  for (const auto& [record, field] : {std::pair{0, 10}, std::pair{1, 1}, std::pair{1, 3}}) {
    std::vector<uint8_t> content;
    for (size_t i = 0; i < kEntries; ++i) {
      content.push_back(static_cast<uint8_t>(field << 3 | 2));
      content.push_back(0);
    }
    const Result<LoadedMap> loaded =
        DecodeMap(Rewrite(bytes, static_cast<size_t>(record), content), "bomb");
    ASSERT_FALSE(loaded);
    EXPECT_THAT(loaded.error().message, HasSubstr("more than half of the allowed 2048 MB"));
  }
}

TEST(MapFile, SurfaceBeyondTheFirstBlocksIsPackedWhenItIsLoaded) {
  const SemanticMap map = RandomMap(1, 60'000);
  const VoxelMapMemory memory = MeasureMemory(map.voxels);
  ASSERT_GT(memory.surface_blocks, 11'000u);
  const Result<LoadedMap> loaded = DecodeMap(EncodeMap(map, {}), "large");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->map_hash, HashMap(map));
  const VoxelMapMemory after = MeasureMemory(loaded->map.voxels);
  EXPECT_GT(after.packed_blocks, 1000u);
  EXPECT_LT(after.surface_blocks - after.packed_blocks, 10'000u);
}

TEST(MapFile, RecordsMissingOrInAnotherOrderAreAnError) {
  const std::vector<uint8_t> bytes = EncodeMap(RandomMap(1, 900), {});
  const auto records = mapfile::SplitRecords(bytes);
  ASSERT_GT(records->size(), 5u);
  for (size_t left_out = 0; left_out < records->size(); ++left_out) {
    std::vector<uint8_t> missing = mapfile::FilePrefix();
    std::vector<uint8_t> moved = mapfile::FilePrefix();
    for (size_t i = 0; i < records->size(); ++i) {
      if (i == left_out) continue;
      mapfile::AppendRecord((*records)[i].kind, (*records)[i].content, &missing);
      mapfile::AppendRecord((*records)[i].kind, (*records)[i].content, &moved);
    }
    EXPECT_FALSE(DecodeMap(missing, "missing")) << left_out;
    if (left_out + 1 == records->size()) continue;
    mapfile::AppendRecord((*records)[left_out].kind, (*records)[left_out].content, &moved);
    EXPECT_FALSE(DecodeMap(moved, "moved")) << left_out;
  }
}

TEST(MapFile, ForeignAndNewerFilesAreNamed) {
  const std::string text = "ply\nformat ascii 1.0\n";
  const auto foreign =
      DecodeMap(std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()), "a.ply");
  ASSERT_FALSE(foreign);
  EXPECT_THAT(foreign.error().message, HasSubstr("a.ply: it is not a map file of vismap"));
  std::vector<uint8_t> newer = EncodeMap(RandomMap(1, 3), {});
  newer[8] = 2;
  const auto loaded = DecodeMap(newer, "b.vismap");
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message,
              HasSubstr("expected map format 1, found 2; a newer version of vismap"));
}

TEST(MapFile, FileRoundTripAndErrorsOfTheSystem) {
  const std::filesystem::path folder =
      ::testing::TempDir() + "vismap_mapfile_" + std::to_string(getpid());
  std::filesystem::create_directories(folder);
  const SemanticMap map = RandomMap(2, 50);
  const Result<SaveInfo> saved = SaveMap(map, SomeMetadata(), folder / "map.vismap");
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_TRUE(saved->path.is_absolute());
  EXPECT_EQ(saved->bytes, std::filesystem::file_size(saved->path));
  EXPECT_EQ(saved->map_hash, HashMap(map));
  const Result<LoadedMap> loaded = LoadMap(saved->path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  ExpectSameMap(loaded->map, map);
  const auto missing = LoadMap(folder / "none.vismap");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("none.vismap"));
  EXPECT_FALSE(SaveMap(map, {}, folder / "no" / "folder.vismap"));
  std::filesystem::remove_all(folder);
}

TEST(BlockChunk, EveryCutAndClaimIsAnError) {
  const SemanticMap map = RandomMap(6, 12);
  const std::vector<BlockIndex> indices = map.voxels.SortedIndices();
  const std::vector<uint8_t> bytes = mapfile::EncodeBlocks(map.voxels, indices);
  ASSERT_TRUE(mapfile::DecodeBlocks(bytes, indices.size(), 39));
  EXPECT_FALSE(mapfile::DecodeBlocks(bytes, indices.size(), 1)) << "votes for unknown labels";
  for (const size_t blocks : {size_t{0}, indices.size() - 1, indices.size() + 1, size_t{1} << 40}) {
    EXPECT_FALSE(mapfile::DecodeBlocks(bytes, blocks, 39)) << blocks;
  }
  for (size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
    EXPECT_FALSE(mapfile::DecodeBlocks(std::span(bytes.data(), size), indices.size(), 39)) << size;
  }
}

TEST(BlockChunk, FlippedBitsGiveValidBlocksOrAnError) {
  const SemanticMap map = RandomMap(6, 12);
  const std::vector<BlockIndex> indices = map.voxels.SortedIndices();
  const std::vector<uint8_t> bytes = mapfile::EncodeBlocks(map.voxels, indices);
  uint64_t state = 8;
  for (int i = 0; i < 2000; ++i) {
    std::vector<uint8_t> flipped = bytes;
    const size_t range = i % 2 == 0 ? 200 : bytes.size();
    flipped[Next(&state) % range] ^= static_cast<uint8_t>(1 << Next(&state) % 8);
    const auto blocks = mapfile::DecodeBlocks(flipped, indices.size(), 39);
    if (!blocks) continue;
    for (const auto& [index, block] : *blocks) {
      if (!block.surface) continue;
      for (int voxel = 0; voxel < kBlockVoxels; ++voxel) {
        for (int slot = 0; slot < kVoteSlots; ++slot) {
          ASSERT_LE(Raw(block.surface->Vote(voxel, slot).label), 39u);
        }
      }
    }
  }
}

TEST(ThinChunk, OnlyWhatIsWrittenIsRead) {
  const SemanticMap map = RandomMap(6, 40);
  const std::vector<BlockIndex> indices = map.voxels.SortedIndices();
  const std::string text = mapfile::EncodeThin(map.voxels, indices);
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  ASSERT_GT(bytes.size(), 50u);
  const auto decode = [](std::span<const uint8_t> some, size_t blocks) {
    std::vector<mapfile::IndexedBlock> decoded(blocks);
    return mapfile::DecodeThin(some, &decoded).has_value();
  };
  EXPECT_TRUE(decode(bytes, indices.size()));
  EXPECT_TRUE(decode({}, 0));
  EXPECT_FALSE(decode(bytes, 1)) << "hits of blocks that are not in the chunk";
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::vector<uint8_t> flipped = bytes;
    flipped[i] ^= static_cast<uint8_t>(1 + i % 255);
    std::vector<mapfile::IndexedBlock> decoded(indices.size());
    if (!mapfile::DecodeThin(flipped, &decoded)) continue;
    for (const auto& [index, block] : decoded) {
      for (int voxel = 0; block.thin && voxel < kBlockVoxels; ++voxel)
        EXPECT_LE(block.thin->hits[static_cast<size_t>(voxel)], ThinVoxels::kMost);
    }
  }
  int whole = 0;
  for (size_t size = 1; size < bytes.size(); ++size)
    whole += decode(std::span(bytes.data(), size), indices.size()) ? 1 : 0;
  EXPECT_LT(whole, 10) << "only between two blocks";
}

}  // namespace
}  // namespace vismap
