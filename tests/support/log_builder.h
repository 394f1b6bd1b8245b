#pragma once

#include <map>
#include <string>
#include <vector>
#include <vismap/frame_commit_t.hpp>

#include "logs/log_writer.h"
#include "support/messages.h"
#include "support/temp_folder.h"
#include "wire/channels.h"
#include "wire/detections.h"
#include "wire/envelope.h"
#include "wire/frame_key.h"
#include "wire/rgbd_frame.h"

namespace vismap {

/// Makes a log message by message, 10 ms apart, as the processes would send them.
class LogBuilder {
 public:
  explicit LogBuilder(const std::string& name = "run.lcmlog")
      : path_(folder_ / name), writer_(*LogWriter::Create(path_)) {}

  template <typename Message>
  LogBuilder& Add(const Channel& channel, Message message, const std::string& source = "test") {
    message.source = source;
    message.seq = seq_[source + channel.name]++;
    return AddBytes(channel.name, Pack(message));
  }
  LogBuilder& AddBytes(const std::string& channel, const std::vector<uint8_t>& bytes) {
    writer_.Add(time_ += 10000, channel, bytes);
    return *this;
  }
  LogBuilder& Frame(int64_t utime, int camera = 3) {
    return Add(kRgbdFrameChannel, Encode(SmallSensorFrame(utime, camera)), "sensor-replay");
  }
  LogBuilder& Detections(int64_t utime, int camera = 3) {
    return Add(kDetectionsChannel,
               Encode(SmallDetections(utime, camera), kSmallCamera.width, kSmallCamera.height),
               "detector");
  }
  /// Adds a commit of the frame, integrated with detections, as this revision of the map.
  frame_commit_t Committed(int64_t utime, int64_t revision, int camera = 3) const {
    frame_commit_t commit{};
    commit.utime = utime;
    commit.camera_id = camera;
    commit.frame_number = 17;
    commit.map_id = "map-1";
    commit.revision = revision;
    commit.status = frame_commit_t::STATUS_INTEGRATED;
    commit.had_detections = true;
    commit.input_digest = "input" + std::to_string(utime);
    commit.digest = "digest" + std::to_string(utime);
    return commit;
  }
  LogBuilder& Commit(int64_t utime, int64_t revision, int camera = 3) {
    return Add(kMapCommitChannel, Committed(utime, revision, camera), "map-server");
  }
  LogBuilder& Skip(int64_t utime, const std::string& reason, int camera = 3) {
    frame_commit_t commit = Committed(utime, 0, camera);
    commit.status = frame_commit_t::STATUS_SKIPPED;
    commit.reason = reason;
    commit.digest = "";
    return Add(kMapCommitChannel, commit, "map-server");
  }
  /// Writes the log and returns its path.
  std::string Finish() {
    const Result<void> finished = writer_.Finish();
    if (!finished) throw std::runtime_error(finished.error().message);
    return path_.string();
  }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
  std::filesystem::path path_;
  LogWriter writer_;
  int64_t time_ = 1'700'000'000'000'000;
  std::map<std::string, int64_t> seq_;
};

}  // namespace vismap
