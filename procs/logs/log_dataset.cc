#include "logs/log_dataset.h"

#include <filesystem>
#include <utility>

#include "base/require.h"
#include "wire/detections.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

FrameKey KeyOfHeader(const FrameHeader& header) { return {header.camera_id, header.utime}; }

// Selects the frames of the newest map that are in the log.
void SelectCommitted(const RecordedRun& run, FrameSelection* selection) {
  MapHistory history = HistoryOfNewestMap(run.commits);
  selection->remarks = std::move(history.remarks);
  std::set<size_t> taken;
  for (const frame_commit_t& commit : history.integrated) {
    const FrameKey key = KeyOf(commit);
    const auto found = run.index.find(key);
    if (found == run.index.end()) {
      selection->skipped.push_back(
          {commit.frame_number,
           ToText(key) + " was committed, but its RGBD_FRAME is not in the log"});
      selection->remarks.push_back(
          "the RGBD_FRAME of " + ToText(key) +
          " is not in the log, so the map will differ from the recorded one");
      continue;
    }
    taken.insert(found->second);
    selection->frames.push_back(run.frames[found->second]);
    if (commit.had_detections && !run.detections.contains(key)) {
      selection->remarks.push_back(
          "the DETECTIONS of " + ToText(key) +
          " are not in the log, so the map will differ from the recorded one");
    }
  }
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (taken.contains(i)) continue;
    const FrameHeader& header = run.frames[i].header;
    selection->skipped.push_back(
        {header.frame_number,
         ToText(KeyOfHeader(header)) + " was not committed in the recorded run"});
  }
}

std::vector<RecordedFrame> LimitFrames(std::vector<RecordedFrame> frames,
                                       const DatasetOptions& options) {
  std::vector<RecordedFrame> chosen;
  for (size_t i = 0; i < frames.size(); i += static_cast<size_t>(options.stride)) {
    if (options.max_frames > 0 && chosen.size() == static_cast<size_t>(options.max_frames)) break;
    chosen.push_back(std::move(frames[i]));
  }
  return chosen;
}

}  // namespace

FrameSelection SelectFrames(const RecordedRun& run, bool all, const DatasetOptions& options) {
  FrameSelection selection;
  if (all || run.commits.empty()) {
    selection.frames = run.frames;
  } else {
    SelectCommitted(run, &selection);
  }
  selection.skipped.insert(selection.skipped.end(), run.unusable_frames.begin(),
                           run.unusable_frames.end());
  selection.frames = LimitFrames(std::move(selection.frames), options);
  return selection;
}

LogDataset::LogDataset(LogReader reader, FrameSelection selection,
                       std::optional<std::string> detections_path, const DatasetOptions& options)
    : reader_(std::move(reader)),
      selection_(std::move(selection)),
      detections_path_(std::move(detections_path)),
      options_(options) {}

std::string LogDataset::name() const {
  return std::filesystem::path(reader_.path()).filename().string();
}

FrameHeader LogDataset::Header(size_t i) const {
  Require(i < size(), "the index of a frame is below the number of frames");
  FrameHeader header = selection_.frames[i].header;
  if (options_.intrinsics) {
    const auto& [fx, fy, cx, cy] = *options_.intrinsics;
    header.camera = {header.camera.width, header.camera.height, fx, fy, cx, cy};
  }
  return header;
}

std::vector<std::string> LogDataset::remarks() const {
  std::vector<std::string> remarks;
  std::set<CameraId> told;
  for (size_t i = 0; i < size(); ++i) {
    const FrameHeader header = Header(i);
    if (!told.insert(header.camera_id).second) continue;
    remarks.push_back(
        "camera " + std::to_string(Raw(header.camera_id)) + ": " + CameraText(header.camera) +
        (options_.intrinsics ? ": the option --intrinsics" : ": from the RGBD_FRAMEs of the log"));
  }
  return remarks;
}

// Returns the first copy that is not damaged, as in the recorded run.
Result<SensorFrame> LogDataset::Read(size_t i) const {
  const FrameKey key = KeyOfHeader(Header(i));
  std::string problem;
  for (const LogEvent& copy : selection_.frames[i].copies) {
    const auto message = ReadMessage<rgbd_frame_t>(reader_, copy, kRgbdFrameChannel);
    if (!message) {
      problem = message.error().message;
      continue;
    }
    Result<SensorFrame> frame = Decode(*message);
    if (frame && frame->optics && options_.intrinsics) {
      problem = reader_.path() +
                ": the frame states its lens and cameras; no other intrinsics can "
                "be given (--intrinsics)";
      break;
    }
    if (frame) {
      if (options_.intrinsics) frame->header.camera = Header(i).camera;
      if (options_.depth_unit_m > 0) frame->depth_unit_m = options_.depth_unit_m;
      return frame;
    }
    problem = reader_.path() + ": " + frame.error().message;
  }
  return Fail(problem + " (" + ToText(key) + ")");
}

LogDetections::LogDetections(LogReader reader, const RecordedRun& run, bool all)
    : reader_(std::move(reader)), messages_(run.detections) {
  if (all) return;
  for (const frame_commit_t& commit : HistoryOfNewestMap(run.commits).integrated) {
    if (!commit.had_detections) messages_.erase(KeyOf(commit));
  }
}

bool LogDetections::DetectorRan(const FrameHeader& header) const {
  return messages_.contains(KeyOfHeader(header));
}

Result<DetectionSet> LogDetections::ForFrame(const FrameHeader& header) const {
  const auto found = messages_.find(KeyOfHeader(header));
  if (found == messages_.end())
    return DetectionSet{header.utime, header.camera_id, header.frame_number, {}};
  const auto message = ReadMessage<detections_t>(reader_, found->second, kDetectionsChannel);
  if (!message) return tl::unexpected(message.error());
  if (message->image_width != header.camera.width ||
      message->image_height != header.camera.height) {
    return Fail(reader_.path() + ": the masks of " + ToText(found->first) + " are for images of " +
                std::to_string(message->image_width) + "x" + std::to_string(message->image_height) +
                ", the frame has " + std::to_string(header.camera.width) + "x" +
                std::to_string(header.camera.height));
  }
  return Decode(*message);
}

}  // namespace vismap
