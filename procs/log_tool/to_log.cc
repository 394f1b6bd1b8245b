#include "base/format.h"
#include "base/reason_counts.h"
#include "log_tool/convert.h"
#include "logs/log_writer.h"
#include "wire/channels.h"
#include "wire/detections.h"
#include "wire/envelope.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

/// Writes a message to the log as a process would publish it on a bus.
template <typename Message>
void Add(Message message, const std::string& channel, int64_t seq, LogWriter* writer) {
  message.source = "vismap-log";
  message.seq = seq;
  writer->Add(message.utime, channel, Pack(message));
}

}  // namespace

Result<ConvertResult> WriteLog(const Dataset& dataset, const DetectionSource* detections,
                               const std::filesystem::path& log,
                               const std::string& channel_prefix) {
  const std::string frame_channel = channel_prefix + kRgbdFrameChannel.name;
  const std::string detections_channel = channel_prefix + kDetectionsChannel.name;
  Result<LogWriter> writer = LogWriter::Create(log);
  if (!writer) return tl::unexpected(writer.error());
  ConvertResult result;
  int64_t detection_messages = 0;
  ReasonCounts left_out, without_color;
  for (const SkippedFrame& skipped : dataset.skipped()) left_out.Add(skipped.reason);
  for (size_t i = 0; i < dataset.size(); ++i) {
    const Result<SensorFrame> frame = dataset.Read(i);
    if (!frame) {
      left_out.Add(frame.error().message);
      continue;
    }
    if (!frame->color_problem.empty()) without_color.Add(frame->color_problem);
    const FrameHeader& header = frame->header;
    Add(Encode(*frame), frame_channel, result.frames++, &*writer);
    if (detections == nullptr || !detections->DetectorRan(header)) continue;
    const Result<DetectionSet> set = detections->ForFrame(header);
    if (!set) return tl::unexpected(set.error());
    Add(Encode(*set, header.camera.width, header.camera.height), detections_channel,
        detection_messages++, &*writer);
  }
  const int64_t all = result.frames + left_out.total();
  if (result.frames == 0) return Fail(dataset.name() + ": " + NoUsableFramesText(left_out, all));
  if (const Result<void> finished = writer->Finish(); !finished)
    return tl::unexpected(finished.error());
  if (left_out.total() > 0) result.lost.push_back(LeftOutText(left_out, all));
  if (without_color.total() > 0) {
    result.lost.push_back("the colour of " + FormatCount(without_color.total(), "frame") + ": " +
                          without_color.Text());
  }
  return result;
}

}  // namespace vismap
