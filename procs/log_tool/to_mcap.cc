#include "log_tool/to_mcap.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "codecs/label_codec.h"
#include "log_tool/status_topics.h"
#include "logs/foreign_dataset.h"
#include "logs/recorded_run.h"
#include "mcap/frame_topics.h"
#include "navigation/tree_leaves.h"
#include "wire/channels.h"
#include "wire/detections.h"
#include "wire/grid_message.h"
#include "wire/map_update.h"
#include "wire/object_list.h"
#include "wire/octree_message.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

constexpr size_t kMostNamed = 256;  // channels without a counterpart

/// Writes the messages of a log one after the other.
class LogExporter {
 public:
  LogExporter(const LogReader& reader, const MapTopicOptions& options,
              const std::set<std::string>& channels, FoxgloveFile* file)
      : reader_(reader),
        file_(*file),
        frames_(file),
        surface_(options, file),
        space_(options, file),
        status_(file) {
    handlers_ = {
        {kRgbdFrameChannel.name, &LogExporter::OnFrame},
        {kDetectionsChannel.name, &LogExporter::OnDetections},
        {kSegmentedFrameChannel.name, &LogExporter::OnSegmentedFrame},
        {kMapCommitChannel.name, &LogExporter::OnCommit},
        {kObjectsChannel.name, &LogExporter::OnObjects},
        {kGridChannel.name, &LogExporter::OnGrid},
        {kStatusChannel.name, &LogExporter::OnStatus},
    };
    const bool has_updates = channels.contains(kMapDeltaChannel.name);
    if (!has_updates) handlers_[kOctomapRawChannel.name] = &LogExporter::OnTree;
    if (has_updates || channels.contains(kOctomapRawChannel.name))
      for (const Channel& channel :
           {kOctomapChannel, kOctomapRawChannel, kOctomapCoarseChannel, kOctomapDeltaChannel})
        covered_.insert(channel.name);
  }

  /// Takes an event; `own` is the name of our channel. Map updates are followed also when nothing
  /// is written.
  void Take(const LogEvent& event, const std::string& own, bool write) {
    if (own == kMeshDeltaChannel.name) {
      OnMesh(event);
    } else if (own == kMapDeltaChannel.name) {
      OnSpace(event);
    } else if (const auto handler = handlers_.find(own); !write) {
      return;
    } else if (handler != handlers_.end()) {
      (this->*handler->second)(event);
    } else if (covered_.contains(own)) {
      ++result_.other_octrees[event.channel];
    } else {
      CountWithoutCounterpart(event.channel);
    }
    if (!write) return;
    newest_us_ = event.timestamp;
    surface_.WriteDue(event.timestamp);
    space_.WriteDue(event.timestamp);
  }

  McapExport Finish() {
    frames_.Finish();
    if (!frames_.Remark().empty()) result_.remarks.push_back(frames_.Remark());
    surface_.Finish(newest_us_);
    space_.Finish(newest_us_);
    AddGaps("surface", surface_.gaps());
    AddGaps("free space", space_.gaps());
    result_.topics = file_.counts();
    return std::move(result_);
  }

 private:
  using Handler = void (LogExporter::*)(const LogEvent&);

  // Reads and decodes the message of an event; counts it when that fails.
  template <typename Message>
  std::optional<Message> Read(const LogEvent& event, const Channel& channel) {
    Result<Message> message = ReadMessage<Message>(reader_, event, channel);
    if (message) return std::move(*message);
    CountUnusable(channel.name, message.error());
    return std::nullopt;
  }
  // Reads a message and makes the value of it that it stands for.
  template <typename Message>
  auto ReadValue(const LogEvent& event, const Channel& channel)
      -> std::optional<typename decltype(Decode(Message{}))::value_type> {
    const std::optional<Message> message = Read<Message>(event, channel);
    if (!message) return std::nullopt;
    auto value = Decode(*message);
    if (value) return std::move(*value);
    CountUnusable(channel.name, value.error());
    return std::nullopt;
  }
  void CountWithoutCounterpart(const std::string& channel) {
    std::map<std::string, int64_t>& counts = result_.without_counterpart;
    const bool named = counts.size() < kMostNamed || counts.contains(channel);
    ++counts[named ? channel : "other channels"];
  }
  void CountUnusable(const std::string& channel, const Error& error) {
    result_.unusable.Add(channel + ": " + error.message);
  }
  void AddGaps(const std::string& what, int64_t gaps) {
    if (gaps == 0) return;
    result_.remarks.push_back("updates of the " + what + " are missing in the log at " +
                              std::to_string(gaps) + (gaps == 1 ? " place" : " places") +
                              "; it stands still there until the next whole one");
  }
  void CountOutcome(const Channel& channel, FollowOutcome outcome) {
    if (outcome == FollowOutcome::kBroken)
      CountUnusable(channel.name, {"the update contradicts itself or those before it"});
    if (outcome == FollowOutcome::kTooLarge)
      CountUnusable(channel.name, {"the map needs more memory than the limit of 1024 MB"});
  }

  void OnFrame(const LogEvent& event) {
    const auto frame = ReadValue<rgbd_frame_t>(event, kRgbdFrameChannel);
    if (frame && !frames_.WriteFrame(*frame, event.timestamp)) ++result_.repeated;
  }

  void OnDetections(const LogEvent& event) {
    const auto message = Read<detections_t>(event, kDetectionsChannel);
    if (!message || !DetectorRan(*message)) return;
    const auto set = Decode(*message);
    if (set)
      frames_.WriteDetections(*set, event.timestamp);
    else
      CountUnusable(kDetectionsChannel.name, set.error());
  }

  void OnSegmentedFrame(const LogEvent& event) {
    const auto message = Read<segmented_frame_t>(event, kSegmentedFrameChannel);
    if (!message) return;
    const auto header = DecodeHeader(message->frame);
    if (!header) return CountUnusable(kSegmentedFrameChannel.name, header.error());
    const FrameKey key{header->camera_id, header->utime};
    if (!frames_.Contains(key)) {
      const auto frame = Decode(message->frame);
      if (!frame) return CountUnusable(kSegmentedFrameChannel.name, frame.error());
      frames_.WriteFrame(*frame, event.timestamp);
    }
    const PinholeCamera& camera = header->camera;
    const auto image = DecodeSegmentImage(message->labels, camera.width, camera.height);
    if (!image) return CountUnusable(kSegmentedFrameChannel.name, image.error());
    frames_.WriteSegments(key, camera, *image, event.timestamp);
  }

  void OnCommit(const LogEvent& event) {
    const auto commit = Read<frame_commit_t>(event, kMapCommitChannel);
    if (!commit) return;
    const nlohmann::ordered_json json{{"utime", commit->utime},
                                      {"camera_id", commit->camera_id},
                                      {"map_id", commit->map_id},
                                      {"revision", commit->revision},
                                      {"status", commit->status},
                                      {"reason", commit->reason},
                                      {"had_detections", commit->had_detections},
                                      {"digest", commit->digest}};
    file_.WriteJson("/map/commits", {event.timestamp, commit->utime}, "vismap.frame_commit",
                    json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }

  void OnMesh(const LogEvent& event) {
    if (const auto update = Read<mesh_delta_t>(event, kMeshDeltaChannel))
      CountOutcome(kMeshDeltaChannel, surface_.Apply(*update, event.timestamp));
  }

  void OnSpace(const LogEvent& event) {
    if (auto update = ReadValue<map_delta_t>(event, kMapDeltaChannel))
      CountOutcome(kMapDeltaChannel, space_.Apply(std::move(*update), event.timestamp));
  }

  void OnObjects(const LogEvent& event) {
    const auto message = Read<object_list_t>(event, kObjectsChannel);
    if (!message) return;
    const auto list = Decode(*message);
    if (!list) return CountUnusable(kObjectsChannel.name, list.error());
    std::map<ClassId, std::string> names;
    for (const object_t& object : message->objects)
      names.emplace(static_cast<ClassId>(object.class_id), object.class_name);
    const auto name_of = [&](ClassId id) { return names.contains(id) ? names.at(id) : ""; };
    file_.Write("/map/objects", {event.timestamp, list->utime},
                ObjectsMessage(*list, name_of, event.timestamp));
  }

  void OnGrid(const LogEvent& event) {
    const auto grid = ReadValue<occupancy_grid_t>(event, kGridChannel);
    if (!grid) return;
    if (!grid_.SetTo(grid->map_id, grid->revision)) {
      ++result_.repeated;
    } else if (!grid->grid.states.empty()) {
      file_.Write("/map/grid", {event.timestamp, grid->published_utime}, GroundGridMessage(*grid));
    }
  }

  void OnTree(const LogEvent& event) {
    const auto tree = ReadValue<octree_t>(event, kOctomapRawChannel);
    if (!tree) return;
    if (!tree_.SetTo(tree->map_id, tree->revision)) {
      ++result_.repeated;
      return;
    }
    Result<OccupancyMap> leaves = ReadTreeLeaves(tree->octree.bytes, kOctomapRawChannel.name);
    if (leaves)
      space_.Set(std::move(*leaves), tree->utime);
    else
      CountUnusable(kOctomapRawChannel.name, leaves.error());
  }

  void OnStatus(const LogEvent& event) {
    if (const auto status = Read<process_status_t>(event, kStatusChannel))
      status_.Write(*status, event.timestamp);
  }

  // Of what map something was made last.
  struct Source {
    FollowerPosition position;
    bool SetTo(const std::string& map_id, int64_t revision) {
      const FollowerPosition now{map_id, revision};
      if (now == position) return false;
      position = now;
      return true;
    }
  };

  const LogReader& reader_;
  std::set<std::string> covered_;  // channels whose content other ones have
  FoxgloveFile& file_;
  FrameTopics frames_;
  SurfaceTopics surface_;
  SpaceTopics space_;
  StatusTopics status_;
  Source grid_, tree_;
  std::map<std::string, Handler> handlers_;
  McapExport result_;
  int64_t newest_us_ = 0;
};

// The channels of ours that a log has.
Result<std::set<std::string>> OwnChannelsOf(const LogReader& log, const StopSignal* stop) {
  Result<LogReader> reader = LogReader::Open(log.path(), log.channel_prefix());
  if (!reader) return tl::unexpected(reader.error());
  std::set<std::string> channels;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    if (stop != nullptr && stop->requested()) return Fail(kMcapStopped);
    const std::string own = reader->OwnChannel(event);
    const bool ours = std::any_of(kAllChannels.begin(), kAllChannels.end(),
                                  [&](const Channel& channel) { return own == channel.name; });
    if (ours) channels.insert(own);
    return {};
  };
  const Result<void> read = ForEachEvent(*reader, on_event, [](const LogDamage&) {});
  if (!read) return tl::unexpected(read.error());
  return channels;
}

}  // namespace

Result<McapExport> WriteMcap(LogReader& reader, const McapExportOptions& options,
                             const std::filesystem::path& out, const StopSignal* stop) {
  if (const auto other = CheckIsNotInput(reader.path(), out); !other)
    return tl::unexpected(other.error());
  const Result<std::set<std::string>> channels = OwnChannelsOf(reader, stop);
  if (!channels) return tl::unexpected(channels.error());
  Result<FoxgloveFile> file = FoxgloveFile::Create(out);
  if (!file) return tl::unexpected(file.error());
  std::set<std::string> used = *channels;
  if (!options.cut.channels.empty())
    std::erase_if(used,
                  [&](const std::string& own) { return !options.cut.channels.contains(own); });
  LogExporter exporter(reader, options.map, used, &*file);
  const CutOptions any_time{-std::numeric_limits<double>::infinity(), std::nullopt,
                            options.cut.channels};
  std::optional<int64_t> start;
  uint64_t damaged_bytes = 0;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    if (stop != nullptr && stop->requested()) return Fail(kMcapStopped);
    if (!start) start = event.timestamp;
    const std::string own = reader.OwnChannel(event);
    if (Keeps(any_time, event, own, *start))
      exporter.Take(event, own, Keeps(options.cut, event, own, *start));
    return {};
  };
  const Result<void> read = ForEachEvent(
      reader, on_event, [&](const LogDamage& damage) { damaged_bytes += damage.bytes; });
  if (!read) return tl::unexpected(read.error());
  if (!start) return Fail(reader.path() + ": the file has no LCM event");
  McapExport result = exporter.Finish();
  result.damaged_bytes = damaged_bytes;
  if (result.topics.empty())
    return Fail(reader.path() +
                ": no message of the log in this time range and on these channels has a "
                "counterpart in Foxglove" +
                (result.unusable.total() > 0 ? " (" + result.unusable.Text() + ")" : ""));
  if (const Result<void> finished = file->Finish(); !finished)
    return tl::unexpected(finished.error());
  result.bytes = file->bytes();
  return result;
}

Result<bool> HasForeignFramesOnly(const LogReader& reader, const AdapterOptions& adapter,
                                  const StopSignal* stop) {
  const Result<std::set<std::string>> channels = OwnChannelsOf(reader, stop);
  if (!channels) return tl::unexpected(channels.error());
  for (const Channel& channel : {kRgbdFrameChannel, kSegmentedFrameChannel, kMeshDeltaChannel,
                                 kMapDeltaChannel, kObjectsChannel})
    if (channels->contains(channel.name)) return false;
  return HasForeignImages(reader.path(), adapter);
}

}  // namespace vismap
