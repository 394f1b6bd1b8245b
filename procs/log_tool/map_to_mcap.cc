#include "log_tool/map_to_mcap.h"

#include <optional>
#include <utility>

#include "geometry/saturated_depth.h"
#include "mcap/frame_topics.h"
#include "objects/mesh_tracker.h"
#include "objects/object_tracker.h"
#include "rectify/rectifier.h"
#include "session/map_frame.h"

namespace vismap {
namespace {

MapTopicOptions AlwaysDue(MapTopicOptions options) {
  options.changes_s = 0;
  return options;
}

/// Maps frames and writes the map as it grows. The surface is made anew where it has changed once
/// in options.changes_s, so that a frame costs little.
class MapExporter {
 public:
  MapExporter(const std::string& map_id, const VismapConfig& config, const MapTopicOptions& options,
              FoxgloveFile* file, FrameTopics* frames)
      : config_(config),
        file_(*file),
        frames_(*frames),
        session_(config, MetadataOf(map_id)),
        mesh_(config.meshing),
        occupancy_(session_.map().voxels.voxel_size()),
        surface_(AlwaysDue(options), file),
        space_(options, file),
        changes_(options.changes_s) {
    mesh_.Start(session_.map());
  }

  Result<void> Map(SensorFrame sensor, const DetectionSet* detections) {
    const FrameHeader& header = sensor.header;
    if (session_.Contains(header.camera_id, header.utime))
      return Fail("the map has a frame of its camera and utime already");
    DropSaturatedDepth(config_.surface, &sensor);
    Result<RgbdFrame> frame = rectifier_.Decode(sensor);
    if (!frame) return tl::unexpected(frame.error());
    const int64_t utime = frame->header.utime;
    const MappedFrame mapped =
        MapFrame(std::move(*frame), detections, config_, &session_, {},
                 [&](const SegmentedFrame& segmented) { WriteSegments(segmented); });
    if (!mapped.delta.refused.empty()) return Fail(mapped.delta.refused);
    mesh_.AddChanges(session_.map(), mapped.delta.changes(), mapped.delta.merged);
    occupancy_.Update(session_.map(), mapped.delta.changed_blocks, config_.free_space);
    changes_.MarkChanged();
    newest_ = utime;
    if (changes_.IsDue(utime)) WriteMap();
    return {};
  }

  void Finish() {
    if (changes_.changed()) WriteMap();
    surface_.Finish(newest_);
    space_.Finish(newest_);
  }

 private:
  static MapMetadata MetadataOf(const std::string& map_id) {
    MapMetadata metadata;
    metadata.map_id = map_id;
    return metadata;
  }

  void WriteSegments(const SegmentedFrame& segmented) {
    const FrameHeader& header = segmented.frame.header;
    frames_.WriteSegments({header.camera_id, header.utime}, header.camera, segmented.image,
                          header.utime);
  }

  void WriteMap() {
    mesh_.MeshChanges(session_.map(), [&](MeshPart part) {
      for (BlockMesh& block : part.blocks) surface_.Set(std::move(block), newest_);
    });
    const auto places = [&](SegmentLabel label) { return mesh_.places().BlocksOf(label); };
    ObjectList list{newest_, session_.metadata().map_id, session_.map().revision, {}};
    for (ObjectSummary& object : objects_.Summarize(session_.map(), mesh_.surfaces(), places,
                                                    ObjectOptionsFor(session_.metadata(), config_)))
      if (!object.is_structure()) list.objects.push_back(std::move(object));
    file_.Write("/map/objects", {newest_, newest_}, ObjectsMessage(list, ClassName, newest_));
    space_.Set(occupancy_, newest_);
    surface_.WriteDue(newest_);
    space_.WriteDue(newest_);
    changes_.MarkWritten(newest_);
  }

  const VismapConfig& config_;
  FoxgloveFile& file_;
  FrameTopics& frames_;
  MapSession session_;
  MeshTracker mesh_;
  ObjectTracker objects_;
  OccupancyMap occupancy_;
  Rectifier rectifier_;
  SurfaceTopics surface_;
  SpaceTopics space_;
  WriteTimer changes_;
  int64_t newest_ = 0;
};

/// Writes the frames of a sequence one after the other.
class SequenceExporter {
 public:
  SequenceExporter(const SequenceToWrite& sequence, const VismapConfig& config,
                   const MapTopicOptions& options, FoxgloveFile* file)
      : sequence_(sequence), file_(*file), frames_(file) {
    if (sequence.with_map) map_.emplace(sequence.dataset.name(), config, options, file, &frames_);
    for (const SkippedFrame& skipped : sequence.dataset.skipped())
      result_.unusable.Add(skipped.reason);
  }

  void Take(size_t i) {
    Result<SensorFrame> frame = sequence_.dataset.Read(i);
    if (!frame) return result_.unusable.Add(frame.error().message);
    const int64_t utime = frame->header.utime;
    if (!frames_.WriteFrame(*frame, utime)) {
      ++result_.repeated;
      return;
    }
    const std::optional<DetectionSet> detections = DetectionsOf(frame->header);
    if (detections) frames_.WriteDetections(*detections, utime);
    if (!map_) return;
    const Result<void> mapped = map_->Map(std::move(*frame), detections ? &*detections : nullptr);
    if (!mapped) result_.unusable.Add(mapped.error().message);
  }

  McapExport Finish() {
    if (map_) map_->Finish();
    frames_.Finish();
    if (!frames_.Remark().empty()) result_.remarks.push_back(frames_.Remark());
    result_.topics = file_.counts();
    return std::move(result_);
  }

 private:
  std::optional<DetectionSet> DetectionsOf(const FrameHeader& header) {
    if (sequence_.detections == nullptr || !sequence_.detections->DetectorRan(header))
      return std::nullopt;
    Result<DetectionSet> set = sequence_.detections->ForFrame(header);
    if (set) return std::move(*set);
    result_.unusable.Add(set.error().message);
    return std::nullopt;
  }

  SequenceToWrite sequence_;
  FoxgloveFile& file_;
  FrameTopics frames_;
  std::optional<MapExporter> map_;
  McapExport result_;
};

}  // namespace

Result<McapExport> WriteMcap(const SequenceToWrite& sequence, const VismapConfig& config,
                             const MapTopicOptions& options, const std::filesystem::path& out,
                             const StopSignal* stop) {
  Result<FoxgloveFile> file = FoxgloveFile::Create(out);
  if (!file) return tl::unexpected(file.error());
  SequenceExporter exporter(sequence, config, options, &*file);
  for (size_t i = 0; i < sequence.dataset.size(); ++i) {
    if (stop != nullptr && stop->requested()) return Fail(kMcapStopped);
    exporter.Take(i);
  }
  McapExport result = exporter.Finish();
  if (result.topics.empty())
    return Fail(sequence.dataset.name() + ": " +
                NoUsableFramesText(result.unusable, result.unusable.total()));
  if (const Result<void> finished = file->Finish(); !finished)
    return tl::unexpected(finished.error());
  result.bytes = file->bytes();
  return result;
}

}  // namespace vismap
