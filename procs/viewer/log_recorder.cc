#include "viewer/log_recorder.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "base/class_names.h"
#include "base/parallel.h"
#include "exports/objects_json.h"
#include "exports/outputs.h"
#include "viewer/block_code.h"
#include "viewer/segment_picture.h"
#include "wire/mesh_follower.h"
#include "wire/mesh_update.h"
#include "wire/object_list.h"

namespace vismap {
namespace {

constexpr uint64_t kObjectsPeriod =
    500000;  // between two lists of objects, in the time of the log [us]

uint64_t TimeBetween(int64_t a, int64_t b) {
  return static_cast<uint64_t>(std::max(a, b)) - static_cast<uint64_t>(std::min(a, b));
}

RecordedBlock Recorded(const mesh_block_t& block, int64_t revision) {
  const BlockIndex index{block.index[0], block.index[1], block.index[2]};
  if (block.n_vertices == 0) return {index};
  const uint64_t hash = MeshDigest::HashOf(block);
  return {index, hash, static_cast<uint32_t>(block.n_triangles),
          CompressBlock(EncodePageBlock(block, hash, revision))};
}

RecordedBlock Recorded(BlockIndex index, const BlockOccupancy& space) {
  if (space.is(CellState::kUnknown)) return {index};
  RecordedBlock block{index, 1};
  if (space.is_uniform()) {
    block.bytes = {static_cast<uint8_t>(space.uniform_state())};
    return block;
  }
  const OccupancyPlanes planes = space.Planes();
  block.bytes.resize(sizeof planes.free + sizeof planes.occupied);
  std::memcpy(block.bytes.data(), planes.free.data(), sizeof planes.free);
  std::memcpy(block.bytes.data() + sizeof planes.free, planes.occupied.data(),
              sizeof planes.occupied);
  return block;
}

}  // namespace

LogRecorder::LogRecorder(const VismapConfig& config, const MapSession* session,
                         LogRecording* recording, LogFrames* frames)
    : config_(config),
      session_(session),
      recording_(recording),
      frames_(frames),
      mesh_(config.meshing),
      space_(config.free_space) {
  mesh_.Start(map());
  recording_->SetGrid(map().voxels.voxel_size(), map().voxels.block_size());
}

void LogRecorder::Expect(const Result<void>& outcome) {
  if (outcome || !failure_.empty()) return;
  failure_ = "the log is recorded to frame " + std::to_string(recorded_) +
             " only: " + outcome.error().message;
}

void LogRecorder::OnSegmented(const SegmentedFrame& frame) {
  view_ = {};
  view_.header = frame.frame.header;
  view_.had_detections = frame.had_detections;
  view_.detections = static_cast<size_t>(std::count_if(
      frame.segments.begin(), frame.segments.end(),
      [](const FrameSegment& segment) { return segment.detection != DetectionIndex::kNone; }));
  picture_ = MakePicture(frame);
  evidence_ = frames_ == nullptr ? nullptr : frames_->Make(frame);
}

void LogRecorder::OnMapped(const MapDelta& delta) {
  if (!failure_.empty()) return;
  mesh_.AddChanges(map(), delta.changes(), delta.merged);
  changed_.insert(changed_.end(), delta.changed_blocks.begin(), delta.changed_blocks.end());
  changed_since_copy_.insert(delta.changed_blocks.begin(), delta.changed_blocks.end());
  Expect(recording_->AddFrame(view_, picture_));
  if (evidence_ != nullptr) frames_->Add(std::move(evidence_), map().revision);
  if (map().revision % recording_->stride() == 0) AddMoment();
  AddCopyIfDue();
}

void LogRecorder::AddMoment() {
  const std::vector<RecordedBlock> surface = SurfaceChanges();
  Expect(recording_->AddMoment(map().revision, map().last_utime, surface, SpaceChanges()));
  if (!failure_.empty()) return;
  recorded_ = map().revision;
  if (objects_utime_ && TimeBetween(view_.header.utime, *objects_utime_) < kObjectsPeriod) return;
  const auto places = [&](SegmentLabel label) { return mesh_.places().BlocksOf(label); };
  const auto objects = objects_.Summarize(map(), mesh_.surfaces(), places,
                                          ObjectOptionsFor(session_->metadata(), config_));
  AddObjects(objects, objects_.up());
}

std::vector<RecordedBlock> LogRecorder::SurfaceChanges() {
  std::vector<RecordedBlock> recorded;
  mesh_.MeshChanges(map(), [&](MeshPart part) {
    MeshUpdate update;
    update.block_size = map().voxels.block_size();
    update.mesh = {part.revision, std::move(part.blocks)};
    const mesh_delta_t message = Encode(update);
    const size_t first = recorded.size();
    recorded.resize(first + message.blocks.size());
    ParallelFor(message.blocks.size(), 16, [&](size_t i) {
      recorded[first + i] = Recorded(message.blocks[i], part.revision);
    });
  });
  std::erase_if(recorded, [&](const RecordedBlock& block) {
    return block.hash == recording_->HashOf(block.index);
  });
  return recorded;
}

std::vector<RecordedBlock> LogRecorder::SpaceChanges() {
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  std::vector<RecordedBlock> recorded;
  for (const auto& [index, space] : space_.Update(map(), changed_).blocks)
    recorded.push_back(Recorded(index, space));
  changed_.clear();
  return recorded;
}

void LogRecorder::AddObjects(const std::vector<ObjectSummary>& objects, const UpDirection& up) {
  objects_utime_ = view_.header.utime;
  const std::string& map_id = recording_->map_id();
  const ObjectList list{map().last_utime, map_id, map().revision, objects};
  Expect(recording_->AddObjects(map().revision, ObjectsText(Encode(list, ClassName)),
                                ObjectsJson(map_id, up, objects, ClassName)));
  AddMarks(objects);
}

// Named objects that are new in the list, and those that are removed or no longer in it.
void LogRecorder::AddMarks(const std::vector<ObjectSummary>& objects) {
  std::map<std::string, std::string> present;
  for (const ObjectSummary& object : objects) {
    if (object.discovered() || object.removed()) continue;
    present.emplace(std::to_string(Raw(object.instance)), ClassName(object.class_id));
  }
  const auto mark = [&](const auto& object, bool appeared) {
    recording_->AddMark({map().revision, map().last_utime, object.first, object.second, appeared});
  };
  for (const auto& object : present) {
    if (!present_.contains(object.first)) mark(object, true);
  }
  for (const auto& object : present_) {
    if (!present.contains(object.first)) mark(object, false);
  }
  present_ = std::move(present);
}

void LogRecorder::AddCopyIfDue() {
  if (map().revision % recording_->copy_stride() != 0) return;
  const auto max_bytes = static_cast<size_t>(config_.viewer.max_map_mb) << 20;
  AddCopy(max_bytes);
}

void LogRecorder::AddCopy(size_t max_bytes) {
  std::vector<BlockIndex> changed(changed_since_copy_.begin(), changed_since_copy_.end());
  changed_since_copy_.clear();
  recording_->AddCopy(map().revision,
                      std::make_shared<const LoadedMap>(LoadedMap{map(), session_->metadata(), ""}),
                      std::move(changed), max_bytes);
}

void LogRecorder::Finish() {
  if (!failure_.empty() || map().revision == 0) return;
  if (map().revision != recorded_) AddMoment();
  const MapProducts products = MakeProducts(map(), session_->metadata(), config_);
  AddObjects(products.objects, products.up);
  AddCopy(SIZE_MAX);
}

}  // namespace vismap
