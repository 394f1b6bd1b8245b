#include "viewer/log_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <random>

#include "base/class_names.h"
#include "config/config.h"
#include "exports/objects_json.h"
#include "exports/outputs.h"
#include "objects/mesh_tracker.h"
#include "sequence_mapper/map_sequence.h"
#include "simulation/sequence.h"
#include "support/temp_folder.h"
#include "viewer/block_code.h"
#include "viewer/log_recorder.h"
#include "viewer/page_moment.h"
#include "wire/mesh_follower.h"
#include "wire/mesh_update.h"

namespace vismap {
namespace {

using testing::HasSubstr;

constexpr const char* kRoom = "synthetic:room?frames=20&width=96";
constexpr uint64_t kMuch = uint64_t{1} << 30;

std::unique_ptr<LogRecording> OpenRecordingOf(uint64_t max_bytes) {
  auto recording = LogRecording::Open("", max_bytes, "map-1");
  EXPECT_TRUE(recording) << recording.error().message;
  return std::move(*recording);
}

// Maps the first frames of the room; all of them with 0.
void MapRoom(const VismapConfig& config, int frames, MapSession* session,
             LogRecorder* recorder = nullptr) {
  const auto dataset = OpenSequence(kRoom, "");
  const auto detections = OpenDetections(kRoom);
  ASSERT_TRUE(dataset && detections);
  OfflineInput input{**dataset, detections->get()};
  if (recorder != nullptr) {
    input.on_segmented = [&](const SegmentedFrame& frame) { recorder->OnSegmented(frame); };
    input.on_mapped = [&](const MapDelta& delta) { recorder->OnMapped(delta); };
  }
  StageTimes times;
  const auto proceed = [&](size_t done) {
    return frames == 0 || done < static_cast<size_t>(frames);
  };
  ASSERT_TRUE(MapSequence(input, config, proceed, session, &times));
  if (recorder != nullptr) recorder->Finish();
}

VismapConfig CoarseConfig() {
  VismapConfig config;
  config.grid.voxel_size_m = 0.03;
  DeriveOptions(&config);
  return config;
}

using Blocks = std::map<BlockIndex, std::vector<uint8_t>>;

// The bytes for a page without the revision at which the block was meshed.
std::vector<uint8_t> WithoutRevision(std::vector<uint8_t> bytes) {
  std::memset(bytes.data() + 20, 0, 4);
  return bytes;
}

// The surface of a map, meshed anew.
Blocks MeshOf(const SemanticMap& map, const MeshingOptions& options, std::string* digest) {
  Blocks blocks;
  MeshDigest sum;
  MeshWholeMap(map, options, [&](std::vector<BlockMesh> meshes) {
    MeshUpdate update;
    update.full = true;
    update.block_size = map.voxels.block_size();
    update.mesh.blocks = std::move(meshes);
    for (const mesh_block_t& block : Encode(update).blocks) {
      if (block.n_vertices == 0) continue;
      const BlockIndex index{block.index[0], block.index[1], block.index[2]};
      const uint64_t hash = MeshDigest::HashOf(block);
      blocks[index] = WithoutRevision(EncodePageBlock(block, hash, 0));
      sum.Set(index, hash);
    }
  });
  *digest = sum.Hex();
  return blocks;
}

// A page that takes what it is told to lack.
struct MomentPage {
  Blocks blocks;
  void Go(PageMoment* view, const Moment& moment) {
    for (const BlockIndex& index : view->Show(moment)) {
      const FrameBytes bytes = view->BytesOf(index);
      if (bytes == nullptr) {
        EXPECT_EQ(blocks.erase(index), 1u) << "a block that the page did not have";
      } else {
        blocks[index] = WithoutRevision(*bytes);
      }
    }
  }
};

TEST(LogRecording, EveryMomentIsTheMapAfterSoManyFramesForwardAndBackward) {
  const VismapConfig config = CoarseConfig();
  const auto recording = OpenRecordingOf(kMuch);
  MapSession session(config, {});
  LogRecorder recorder(config, &session, recording.get());
  MapRoom(config, 0, &session, &recorder);
  ASSERT_EQ(recorder.failure(), "");
  ASSERT_EQ(recording->moments().size(), 20u);
  std::map<int64_t, std::pair<Blocks, std::string>> offline;
  for (const int frames : {1, 5, 12, 19, 20}) {
    MapSession part(config, {});
    MapRoom(config, frames, &part);
    ASSERT_EQ(part.map().revision, frames);
    auto& [blocks, digest] = offline[frames];
    blocks = MeshOf(part.map(), config.meshing, &digest);
  }
  ASSERT_GT(offline[20].first.size(), offline[1].first.size());
  PageMoment view(recording.get());
  MomentPage page;
  for (const int frames : {5, 20, 1, 12, 19, 12, 20, 1, 5}) {
    const std::optional<Moment> moment = recording->MomentAt(frames);
    ASSERT_TRUE(moment && moment->frames == frames);
    page.Go(&view, *moment);
    const auto& [blocks, digest] = offline[frames];
    EXPECT_EQ(page.blocks.size(), moment->blocks);
    EXPECT_TRUE(page.blocks == blocks) << "after " << frames << " frames";
    EXPECT_EQ(view.Summary().mesh_digest, digest);
    EXPECT_EQ(view.Summary().revision, frames);
    EXPECT_TRUE(view.Show(*moment).empty()) << "a page that lacks nothing";
  }
}

TEST(LogRecording, SpaceObjectsCamerasAndCopiesAreThoseOfTheMoment) {
  const VismapConfig config = CoarseConfig();
  const auto recording = OpenRecordingOf(kMuch);
  MapSession session(config, {});
  LogRecorder recorder(config, &session, recording.get());
  MapRoom(config, 0, &session, &recorder);
  for (const int frames : {3, 16, 20}) {
    MapSession part(config, {});
    MapRoom(config, frames, &part);
    const Result<OccupancyMap> space = recording->SpaceAt(frames);
    ASSERT_TRUE(space);
    EXPECT_EQ(space->Digest(), ClassifyMap(part.map(), config.free_space).Digest());
    const auto cameras = recording->CamerasAt(frames);
    ASSERT_EQ(cameras.size(), 1u);
    EXPECT_EQ(cameras[0].second, frames);
    EXPECT_EQ(cameras[0].first.header.utime, part.metadata().trajectory.back().utime);
    EXPECT_EQ(recording->PathFrom(0).size(), 20u);
    const Result<FrameBytes> picture =
        recording->PictureAt(Raw(cameras[0].first.header.camera_id), frames);
    ASSERT_TRUE(picture && *picture != nullptr);
    EXPECT_EQ((**picture)[0], 2);
    const std::string text((*picture)->begin(), (*picture)->end());
    EXPECT_THAT(text, HasSubstr("\"utime\":" + std::to_string(cameras[0].first.header.utime)));
  }
  EXPECT_EQ(recording->CopyAt(18)->map.revision, 16);
  EXPECT_EQ(HashMap(recording->CopyAt(20)->map), HashMap(session.map()));
  const MapProducts products = MakeProducts(session.map(), session.metadata(), config);
  const Result<std::string> json = recording->ObjectsJsonAt(20);
  ASSERT_TRUE(json);
  EXPECT_EQ(*json, ObjectsJson("map-1", products.up, products.objects, ClassName));
  EXPECT_LT(recording->ObjectsTextAt(1)->size(), recording->ObjectsTextAt(20)->size());
  EXPECT_FALSE(recording->marks().empty());
  EXPECT_EQ(recording->ObjectsTextAt(0)->size(), 0u);
}

// A sequence whose frames are a second apart, except for one whose time is far ahead.
class WrongClock : public Dataset {
 public:
  WrongClock(std::unique_ptr<Dataset> frames, size_t wrong)
      : frames_(std::move(frames)), wrong_(wrong) {}
  std::string name() const override { return frames_->name(); }
  std::string format() const override { return frames_->format(); }
  size_t size() const override { return frames_->size(); }
  FrameHeader Header(size_t i) const override {
    FrameHeader header = frames_->Header(i);
    header.utime = 1000000 * static_cast<int64_t>(i + 1) + (i == wrong_ ? int64_t{1} << 50 : 0);
    return header;
  }
  Result<SensorFrame> Read(size_t i) const override {
    Result<SensorFrame> frame = frames_->Read(i);
    if (frame) frame->header.utime = Header(i).utime;
    return frame;
  }
  const std::vector<SkippedFrame>& skipped() const override { return frames_->skipped(); }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }

 private:
  std::unique_ptr<Dataset> frames_;
  size_t wrong_;
};

TEST(LogRecording, ObjectsAreListedAfterAFrameWhoseTimeIsFarAhead) {
  const VismapConfig config = CoarseConfig();
  const auto recording = OpenRecordingOf(kMuch);
  MapSession session(config, {});
  LogRecorder recorder(config, &session, recording.get());
  const WrongClock dataset(std::move(*OpenSequence(kRoom, "")), 3);
  OfflineInput input{dataset};
  input.on_segmented = [&](const SegmentedFrame& frame) { recorder.OnSegmented(frame); };
  input.on_mapped = [&](const MapDelta& delta) { recorder.OnMapped(delta); };
  StageTimes times;
  ASSERT_TRUE(MapSequence(
      input, config, [](size_t done) { return done < 12; }, &session, &times));
  ASSERT_EQ(session.map().revision, 12);
  for (const int frames : {3, 4, 5, 12}) {
    EXPECT_THAT(*recording->ObjectsTextAt(frames),
                HasSubstr("\"revision\":" + std::to_string(frames) + ","));
  }
}

// What the surface of a computed map was after so many frames: hash by block.
using Hashes = std::map<int, uint64_t>;

TEST(LogRecording, BeyondTheBoundEverySecondMomentIsForgottenAndTheOthersStay) {
  std::mt19937 random(5);
  const auto recording = OpenRecordingOf(uint64_t{1} << 20);
  std::map<int64_t, Hashes> truth;
  Hashes now;
  uint64_t written = 0;
  for (int frames = 1; frames <= 400; ++frames) {
    std::vector<RecordedBlock> changed;
    for (int i = 0; i < 8; ++i) {
      const int x = static_cast<int>(random() % 60);
      if (std::any_of(changed.begin(), changed.end(), [&](auto& b) { return b.index.x == x; }))
        continue;
      if (now.contains(x) && random() % 4 == 0) {
        now.erase(x);
        changed.push_back({{x, 0, 0}});
        continue;
      }
      now[x] = random() + uint64_t{1};
      std::vector<uint8_t> bytes(2000);
      std::memcpy(bytes.data(), &now[x], sizeof now[x]);
      for (size_t b = 8; b < bytes.size(); ++b) bytes[b] = static_cast<uint8_t>(random());
      changed.push_back({{x, 0, 0}, now[x], 1, CompressBlock(bytes)});
      written += changed.back().bytes.size();
    }
    truth[frames] = now;
    ASSERT_TRUE(recording->AddMoment(frames, 1000 * frames, changed, {}));
  }
  ASSERT_GT(written, 3 * (uint64_t{1} << 20));
  EXPECT_LT(recording->disk_bytes() + recording->index_bytes(), uint64_t{1} << 20);
  EXPECT_GE(recording->stride(), 4);
  EXPECT_GT(recording->thinnings(), 0);
  const std::vector<Moment> moments = recording->moments();
  ASSERT_GE(moments.size(), 8u);
  EXPECT_EQ(moments.back().frames, 400);
  for (const Moment& moment : moments) {
    Hashes found;
    for (const auto& [index, hash] : recording->SurfaceAt(moment.frames)) {
      found[index.x] = hash;
      const Result<BlockAtMoment> block = recording->BlockAt(index, moment.frames);
      ASSERT_TRUE(block && block->bytes != nullptr);
      uint64_t inside = 0;
      std::memcpy(&inside, block->bytes->data(), sizeof inside);
      EXPECT_EQ(inside, hash);
    }
    EXPECT_EQ(found, truth[moment.frames]) << moment.frames;
    EXPECT_EQ(moment.blocks, found.size());
    EXPECT_EQ(moment.triangles, found.size());
  }
}

TEST(LogRecording, EveryMomentThatStaysKeepsItsListOfObjects) {
  std::mt19937 random(7);
  const auto recording = OpenRecordingOf(uint64_t{1} << 20);
  for (int frames = 1; frames <= 400; ++frames) {
    ASSERT_TRUE(recording->AddMoment(frames, 1000 * frames, {}, {}));
    if (frames % 3 != 1) continue;
    std::string text = std::to_string(frames) + " ";
    for (int i = 0; i < 20000; ++i) text += static_cast<char>(random() & 127);
    ASSERT_TRUE(recording->AddObjects(frames, text, "json of " + text));
  }
  ASSERT_GT(recording->thinnings(), 0);
  ASSERT_GT(recording->moments().front().frames, 1);
  for (const Moment& moment : recording->moments()) {
    const std::string list = std::to_string((moment.frames - 1) / 3 * 3 + 1) + " ";
    const Result<std::string> text = recording->ObjectsTextAt(moment.frames);
    ASSERT_TRUE(text);
    EXPECT_EQ(text->substr(0, list.size()), list) << "after " << moment.frames << " frames";
    EXPECT_THAT(*recording->ObjectsJsonAt(moment.frames), HasSubstr("json of " + list));
  }
}

// A map as it is kept at moments; its blocks do not matter.
std::shared_ptr<const LoadedMap> AnyMap(int64_t revision) {
  auto map = std::make_shared<LoadedMap>(LoadedMap{SemanticMap(VoxelGridOptions{}), {}, ""});
  map->map.revision = revision;
  return map;
}

std::vector<BlockIndex> Row(int first, int count) {
  std::vector<BlockIndex> row;
  for (int x = first; x < first + count; ++x) row.push_back({x, 0, 0});
  return row;
}

TEST(LogRecording, ABlockThatChangesInManyFramesIsOneBlockOfACopy) {
  VismapConfig config = CoarseConfig();
  config.viewer.max_map_mb = 128;
  const auto recording = OpenRecordingOf(kMuch);
  MapSession session(config, {});
  LogRecorder recorder(config, &session, recording.get());
  const auto dataset = OpenSequence("synthetic:room?frames=64&width=96", "");
  OfflineInput input{**dataset};
  size_t changes = 0;
  input.on_segmented = [&](const SegmentedFrame& frame) { recorder.OnSegmented(frame); };
  input.on_mapped = [&](const MapDelta& delta) {
    recorder.OnMapped(delta);
    changes += delta.changed_blocks.size();
  };
  StageTimes times;
  ASSERT_TRUE(MapSequence(
      input, config, [](size_t) { return true; }, &session, &times));
  ASSERT_GT(changes * 7000, size_t{128} << 20) << "they would not fit if each change counted";
  EXPECT_EQ(recording->copy_stride(), 16);
  for (const int frames : {16, 32, 48, 64})
    EXPECT_EQ(recording->CopyAt(frames + 15)->map.revision, frames);
}

TEST(LogRecording, TheBlocksOfADroppedCopyCountWithTheNextOne) {
  const auto recording = OpenRecordingOf(kMuch);
  constexpr size_t kMost = 4500 * 7000;
  // Each copy has 1000 new blocks: the fifth is too much.
  for (int i = 1; i <= 5; ++i)
    recording->AddCopy(16 * i, AnyMap(16 * i), Row(1000 * i, 1000), kMost);
  EXPECT_EQ(recording->copy_stride(), 32);
  EXPECT_EQ(recording->CopyAt(79)->map.revision, 48);
  // No block is gone with the dropped copies, so that there is no room for more.
  recording->AddCopy(96, AnyMap(96), Row(6000, 1), kMost);
  EXPECT_EQ(recording->copy_stride(), 64);
}

TEST(LogRecording, BlocksThatChangedAgainAreFreedWithADroppedCopy) {
  const auto recording = OpenRecordingOf(kMuch);
  constexpr size_t kMost = 4500 * 7000;
  for (int i = 1; i <= 5; ++i) recording->AddCopy(16 * i, AnyMap(16 * i), Row(0, 1000), kMost);
  EXPECT_EQ(recording->copy_stride(), 32);
  recording->AddCopy(96, AnyMap(96), Row(0, 1000), kMost);
  EXPECT_EQ(recording->copy_stride(), 32) << "three copies were left";
}

TEST(LogRecording, LabelsOfACopyCount) {
  const auto recording = OpenRecordingOf(kMuch);
  for (int i = 1; i <= 3; ++i) {
    auto map = std::make_shared<LoadedMap>(LoadedMap{SemanticMap(VoxelGridOptions{}), {}, ""});
    map->map.labels.GrowLabels(SegmentLabel{100000});
    recording->AddCopy(16 * i, map, {}, size_t{32} << 20);
  }
  EXPECT_EQ(recording->copy_stride(), 32);
}

TEST(LogRecording, WhatCannotBeMadeSmallerEndsWithASentence) {
  const auto recording = OpenRecordingOf(1000);
  std::vector<uint8_t> bytes(5000);
  std::mt19937 random(1);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
  const Result<void> added =
      recording->AddMoment(1, 1, {{{0, 0, 0}, 7, 1, CompressBlock(bytes)}}, {});
  ASSERT_FALSE(added);
  EXPECT_THAT(added.error().message, HasSubstr("viewer.log_mb"));
  EXPECT_EQ(recording->MomentAt(1)->blocks, 1u) << "what was recorded stays";
}

TEST(LogRecording, MomentsAreTheNewestNotAfterWhatIsAsked) {
  const auto recording = OpenRecordingOf(kMuch);
  EXPECT_FALSE(recording->MomentAt(5));
  EXPECT_EQ(recording->CopyAt(5), nullptr);
  for (const int frames : {2, 4, 8}) ASSERT_TRUE(recording->AddMoment(frames, frames, {}, {}));
  EXPECT_EQ(recording->MomentAt(-3)->frames, 2);
  EXPECT_EQ(recording->MomentAt(4)->frames, 4);
  EXPECT_EQ(recording->MomentAt(7)->frames, 4);
  EXPECT_EQ(recording->MomentAt(INT64_MAX)->frames, 8);
}

TEST(SpillFile, BytesAreReadBackUntilTheirPartIsDropped) {
  const TempFolder folder;
  Result<SpillFile> file = SpillFile::Open(folder.path().string());
  ASSERT_TRUE(file);
  const std::vector<uint8_t> first{1, 2, 3}, second{4, 5};
  const auto a = file->Append(first), b = file->Append(second);
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "files have no name";
  const std::vector<uint32_t> parts = file->CloseParts();
  const auto c = file->Append(first);
  EXPECT_EQ(*file->Read(*a), first);
  EXPECT_EQ(*file->Read(*b), second);
  EXPECT_EQ(file->bytes(), 8u);
  for (const uint32_t part : parts) file->Drop(part);
  EXPECT_EQ(file->bytes(), 3u);
  EXPECT_FALSE(file->Read(*a));
  EXPECT_EQ(*file->Read(*c), first);
}

TEST(SpillFile, MissingFolderIsNamed) {
  const Result<SpillFile> file = SpillFile::Open("/nowhere/at-all");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("/nowhere/at-all"));
}

}  // namespace
}  // namespace vismap
