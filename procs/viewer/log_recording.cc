#include "viewer/log_recording.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <span>

#include "map/map_bytes.h"
#include "viewer/block_code.h"

namespace vismap {
namespace {

using Lock = std::lock_guard<std::mutex>;

constexpr size_t kBytesPerBlock = 7000;  // of a block that two copies do not share

std::vector<uint8_t> Compress(const std::string& text) {
  return CompressBlock({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

// A block of free space as it is recorded: one byte, or the planes.
BlockOccupancy DecodeSpace(const std::vector<uint8_t>& bytes) {
  if (bytes.size() == 1) return BlockOccupancy(static_cast<CellState>(bytes[0]));
  OccupancyPlanes planes;
  std::memcpy(planes.free.data(), bytes.data(), sizeof planes.free);
  std::memcpy(planes.occupied.data(), bytes.data() + sizeof planes.free, sizeof planes.occupied);
  return BlockOccupancy(planes);
}

std::vector<BlockIndex> Union(const std::vector<BlockIndex>& a, const std::vector<BlockIndex>& b) {
  std::vector<BlockIndex> both;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

template <typename List>
auto NewestOf(const List& list, int64_t frames) {
  return std::upper_bound(list.begin(), list.end(), frames,
                          [](int64_t f, const auto& entry) { return f < entry.frames; });
}

template <typename List>
List EverySecond(const List& list) {
  List kept;
  for (size_t i = 1; i < list.size(); i += 2) kept.push_back(list[i]);
  if (list.size() % 2 == 1) kept.push_back(list.back());  // the newest stays
  return kept;
}

// The entries that are the newest one at some of these moments (numbers of frames, ascending).
template <typename List>
List NewestAt(const std::vector<int64_t>& moments, const List& list) {
  List kept;
  for (const int64_t frames : moments) {
    const auto after = NewestOf(list, frames);
    if (after == list.begin()) continue;
    const auto& newest = *std::prev(after);
    if (kept.empty() || kept.back().frames != newest.frames) kept.push_back(newest);
  }
  return kept;
}

}  // namespace

Result<std::unique_ptr<LogRecording>> LogRecording::Open(const std::string& folder,
                                                         uint64_t max_bytes, std::string map_id) {
  Result<SpillFile> disk = SpillFile::Open(folder);
  if (!disk) return tl::unexpected(disk.error());
  return std::unique_ptr<LogRecording>(
      new LogRecording(std::move(*disk), max_bytes, std::move(map_id)));
}

Result<void> LogRecording::AddFrame(const CameraView& view, const std::vector<uint8_t>& picture) {
  const Lock lock(mutex_);
  const Result<SpillFile::Place> place = disk_.Append(picture);
  if (!place) return tl::unexpected(place.error());
  frames_of_[Raw(view.header.camera_id)].push_back(static_cast<int64_t>(frames_.size()));
  frames_.push_back({view, *place});
  ++changes_;
  return {};
}

// All bytes in one go, since a moment has many small blocks.
Result<void> LogRecording::AddVersions(int64_t frames, const std::vector<RecordedBlock>& blocks,
                                       VersionTable* table) {
  std::vector<uint8_t> bytes;
  for (const RecordedBlock& block : blocks)
    bytes.insert(bytes.end(), block.bytes.begin(), block.bytes.end());
  const Result<SpillFile::Place> all = disk_.Append(bytes);
  if (!all) return tl::unexpected(all.error());
  uint32_t offset = all->offset;
  for (const RecordedBlock& block : blocks) {
    const auto size = static_cast<uint32_t>(block.bytes.size());
    table->Add(
        block.index,
        {static_cast<int32_t>(frames), block.triangles, block.hash, {all->part, offset, size}});
    offset += size;
  }
  return {};
}

Result<void> LogRecording::AddMoment(int64_t frames, int64_t utime,
                                     const std::vector<RecordedBlock>& surface,
                                     const std::vector<RecordedBlock>& space) {
  if (auto entered = EnterMoment(frames, utime, surface, space); !entered) return entered;
  return ThinIfTooLarge();
}

Result<void> LogRecording::EnterMoment(int64_t frames, int64_t utime,
                                       const std::vector<RecordedBlock>& surface,
                                       const std::vector<RecordedBlock>& space) {
  const Lock lock(mutex_);
  Moment moment = moments_.empty() ? Moment{} : moments_.back();
  moment.frames = frames;
  moment.utime = utime;
  for (const RecordedBlock& block : surface) {
    const BlockVersion* before = surface_.At(block.index, frames);
    const BlockVersion old = before == nullptr ? BlockVersion{} : *before;
    moment.digest += block.hash - old.hash;
    moment.triangles += block.triangles;
    moment.triangles -= old.triangles;
    moment.blocks += block.hash != 0 ? 1 : 0;
    moment.blocks -= old.hash != 0 ? 1 : 0;
  }
  if (auto added = AddVersions(frames, surface, &surface_); !added) return added;
  if (auto added = AddVersions(frames, space, &space_); !added) return added;
  moments_.push_back(moment);
  ++changes_;
  return {};
}

Result<void> LogRecording::AddObjects(int64_t frames, const std::string& text,
                                      const std::string& json) {
  const std::vector<uint8_t> text_bytes = Compress(text), json_bytes = Compress(json);
  const Lock lock(mutex_);
  const Result<SpillFile::Place> text_place = disk_.Append(text_bytes);
  if (!text_place) return tl::unexpected(text_place.error());
  const Result<SpillFile::Place> json_place = disk_.Append(json_bytes);
  if (!json_place) return tl::unexpected(json_place.error());
  if (!objects_.empty() && objects_.back().frames == frames) objects_.pop_back();
  objects_.push_back({frames, *text_place, *json_place});
  ++object_lists_;
  ++changes_;
  return {};
}

void LogRecording::AddMark(ObjectMark mark) {
  const Lock lock(mutex_);
  if (marks_.size() < kMostMarks) marks_.push_back(std::move(mark));
  ++changes_;
}

size_t LogRecording::Copy::bytes() const {
  return changed.size() * kBytesPerBlock + BytesOf(map->map.labels) +
         TrajectoryBytes(map->map.revision);
}

void LogRecording::AddCopy(int64_t frames, std::shared_ptr<const LoadedMap> map,
                           std::vector<BlockIndex> changed, size_t max_bytes) {
  std::sort(changed.begin(), changed.end());
  const Lock lock(mutex_);
  copies_[frames] = {std::move(map), std::move(changed)};
  size_t total = 0;
  for (const auto& entry : copies_) total += entry.second.bytes();
  if (total <= max_bytes || copies_.size() < 3) return;
  bool drop = false;
  for (auto copy = std::next(copies_.begin()); std::next(copy) != copies_.end();) {
    const auto next = std::next(copy);
    if (!std::exchange(drop, !drop)) {
      next->second.changed = Union(copy->second.changed, next->second.changed);
      copies_.erase(copy);
    }
    copy = next;
  }
  copy_stride_ = 2 * copy_stride_;
}

void LogRecording::SetState(RecordingState state) {
  const Lock lock(mutex_);
  state_ = std::move(state);
  ++changes_;
}

void LogRecording::SetGrid(double voxel_size_m, double block_edge_m) {
  voxel_size_m_ = voxel_size_m;
  block_edge_m_ = block_edge_m;
}

bool LogRecording::IsTooLarge() const {
  const Lock lock(mutex_);
  return disk_.bytes() + IndexBytes() > max_bytes_;
}

Result<void> LogRecording::ThinIfTooLarge() {
  while (IsTooLarge() && moments().size() >= kLeastMoments) {
    if (auto thinned = ForgetEverySecond(); !thinned) return thinned;
  }
  if (!IsTooLarge()) return {};
  return Fail("the recording needs more than " + std::to_string(max_bytes_ >> 20) +
              " MB (viewer.log_mb)");
}

// Readers have their turn between two parts.
Result<void> LogRecording::ForgetEverySecond() {
  for (const uint32_t part : ThinOut()) {
    if (auto moved = MovePart(part); !moved) return moved;
  }
  return {};
}

// Returns the parts of the file in which something may be no longer needed.
std::vector<uint32_t> LogRecording::ThinOut() {
  const Lock lock(mutex_);
  moments_ = EverySecond(moments_);
  std::vector<int64_t> kept;
  for (const Moment& moment : moments_) kept.push_back(moment.frames);
  surface_.KeepOnly(kept);
  space_.KeepOnly(kept);
  objects_ = NewestAt(kept, objects_);
  for (const auto& [camera, numbers] : frames_of_) {
    bool drop = false;
    for (const int64_t number : numbers) {
      SpillFile::Place& picture = frames_[static_cast<size_t>(number)].picture;
      if (picture.size > 0 && std::exchange(drop, !drop)) picture = {};
    }
  }
  stride_ = 2 * stride_;
  ++thinnings_;
  ++changes_;
  return disk_.CloseParts();
}

// Writes what is still needed of a part anew, and gives the part back.
Result<void> LogRecording::MovePart(uint32_t part) {
  const Lock lock(mutex_);
  std::vector<SpillFile::Place*> places;
  surface_.CollectPlaces(&places);
  space_.CollectPlaces(&places);
  for (RecordedFrame& frame : frames_) places.push_back(&frame.picture);
  for (ObjectTexts& texts : objects_) {
    places.push_back(&texts.text);
    places.push_back(&texts.json);
  }
  std::erase_if(places, [&](const auto* place) { return place->part != part || place->size == 0; });
  std::sort(places.begin(), places.end(),
            [](const auto* a, const auto* b) { return a->offset < b->offset; });
  for (SpillFile::Place* place : places) {
    const Result<std::vector<uint8_t>> bytes = disk_.Read(*place);
    if (!bytes) return tl::unexpected(bytes.error());
    const Result<SpillFile::Place> moved = disk_.Append(*bytes);
    if (!moved) return tl::unexpected(moved.error());
    *place = *moved;
  }
  disk_.Drop(part);
  return {};
}

uint64_t LogRecording::HashOf(BlockIndex index) const {
  const Lock lock(mutex_);
  const BlockVersion* version = surface_.At(index, INT64_MAX);
  return version == nullptr ? 0 : version->hash;
}

RecordingState LogRecording::state() const {
  const Lock lock(mutex_);
  return state_;
}

std::vector<Moment> LogRecording::moments() const {
  const Lock lock(mutex_);
  return moments_;
}

std::vector<ObjectMark> LogRecording::marks() const {
  const Lock lock(mutex_);
  return marks_;
}

std::optional<Moment> LogRecording::MomentAt(int64_t frames) const {
  const Lock lock(mutex_);
  if (moments_.empty()) return std::nullopt;
  const auto after = NewestOf(moments_, frames);
  return after == moments_.begin() ? *after : *std::prev(after);
}

std::optional<Moment> LogRecording::Newest() const {
  const Lock lock(mutex_);
  return moments_.empty() ? std::nullopt : std::optional(moments_.back());
}

std::vector<std::pair<BlockIndex, uint64_t>> LogRecording::SurfaceAt(int64_t frames) const {
  const Lock lock(mutex_);
  std::vector<std::pair<BlockIndex, uint64_t>> blocks;
  surface_.ForEachAt(frames, [&](BlockIndex index, const BlockVersion& version) {
    blocks.emplace_back(index, version.hash);
  });
  return blocks;
}

Result<BlockAtMoment> LogRecording::BlockAt(BlockIndex index, int64_t frames) const {
  Result<std::vector<uint8_t>> compressed;
  uint64_t hash = 0;
  {
    const Lock lock(mutex_);
    const BlockVersion* version = surface_.At(index, frames);
    if (version == nullptr) return BlockAtMoment{};
    hash = version->hash;
    compressed = disk_.Read(version->place);
  }
  if (!compressed) return tl::unexpected(compressed.error());
  Result<std::vector<uint8_t>> bytes = DecompressBlock(*compressed);
  if (!bytes) return tl::unexpected(bytes.error());
  return BlockAtMoment{std::make_shared<const std::vector<uint8_t>>(std::move(*bytes)), hash};
}

Result<OccupancyMap> LogRecording::SpaceAt(int64_t frames) const {
  const Lock lock(mutex_);
  OccupancyMap map(voxel_size_m_);
  Result<void> outcome;
  space_.ForEachAt(frames, [&](BlockIndex index, const BlockVersion& version) {
    const Result<std::vector<uint8_t>> bytes = disk_.Read(version.place);
    if (bytes) {
      map.Set(index, DecodeSpace(*bytes));
    } else {
      outcome = tl::unexpected(bytes.error());
    }
  });
  if (!outcome) return tl::unexpected(outcome.error());
  return map;
}

Result<std::vector<uint8_t>> LogRecording::ReadText(const SpillFile::Place& place) const {
  const Result<std::vector<uint8_t>> compressed = disk_.Read(place);
  if (!compressed) return compressed;
  return DecompressBlock(*compressed);
}

Result<std::string> LogRecording::ObjectsAt(int64_t frames,
                                            SpillFile::Place ObjectTexts::*which) const {
  const Lock lock(mutex_);
  const auto after = NewestOf(objects_, frames);
  if (after == objects_.begin()) return std::string();
  const Result<std::vector<uint8_t>> text = ReadText((*std::prev(after)).*which);
  if (!text) return tl::unexpected(text.error());
  return std::string(text->begin(), text->end());
}

Result<std::string> LogRecording::ObjectsTextAt(int64_t frames) const {
  return ObjectsAt(frames, &ObjectTexts::text);
}

Result<std::string> LogRecording::ObjectsJsonAt(int64_t frames) const {
  return ObjectsAt(frames, &ObjectTexts::json);
}

std::vector<std::pair<CameraView, int64_t>> LogRecording::CamerasAt(int64_t frames) const {
  const Lock lock(mutex_);
  std::vector<std::pair<CameraView, int64_t>> cameras;
  for (const auto& [camera, numbers] : frames_of_) {
    const auto after = std::lower_bound(numbers.begin(), numbers.end(), frames);
    if (after == numbers.begin()) continue;
    CameraView view = frames_[static_cast<size_t>(*std::prev(after))].view;
    view.picture = *std::prev(after) + 1;
    cameras.emplace_back(view, after - numbers.begin());
  }
  return cameras;
}

Result<FrameBytes> LogRecording::PictureAt(int camera_id, int64_t frames) const {
  const Lock lock(mutex_);
  const auto found = frames_of_.find(camera_id);
  if (found == frames_of_.end()) return FrameBytes{};
  const std::vector<int64_t>& numbers = found->second;
  auto at = std::lower_bound(numbers.begin(), numbers.end(), frames);
  while (at != numbers.begin()) {
    const SpillFile::Place& place = frames_[static_cast<size_t>(*--at)].picture;
    if (place.size == 0) continue;
    Result<std::vector<uint8_t>> bytes = disk_.Read(place);
    if (!bytes) return tl::unexpected(bytes.error());
    return std::make_shared<const std::vector<uint8_t>>(std::move(*bytes));
  }
  return FrameBytes{};
}

std::vector<std::pair<int, std::array<float, 3>>> LogRecording::PathFrom(size_t from) const {
  const Lock lock(mutex_);
  std::vector<std::pair<int, std::array<float, 3>>> path;
  for (size_t i = from; i < frames_.size(); ++i) {
    const FrameHeader& header = frames_[i].view.header;
    const Eigen::Vector3f p_W = header.T_W_C.translation().cast<float>();
    path.push_back({Raw(header.camera_id), {p_W.x(), p_W.y(), p_W.z()}});
  }
  return path;
}

std::shared_ptr<const LoadedMap> LogRecording::CopyAt(int64_t frames) const {
  const Lock lock(mutex_);
  if (copies_.empty()) return nullptr;
  const auto after = copies_.upper_bound(frames);
  return after == copies_.begin() ? after->second.map : std::prev(after)->second.map;
}

uint64_t LogRecording::disk_bytes() const {
  const Lock lock(mutex_);
  return disk_.bytes();
}

size_t LogRecording::index_bytes() const {
  const Lock lock(mutex_);
  return IndexBytes();
}

size_t LogRecording::IndexBytes() const {
  return surface_.bytes() + space_.bytes() + frames_.size() * sizeof(RecordedFrame) +
         objects_.size() * sizeof(ObjectTexts);
}

}  // namespace vismap
