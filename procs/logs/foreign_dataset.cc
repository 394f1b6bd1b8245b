#include "logs/foreign_dataset.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <set>

#include "base/enum_names.h"
#include "base/format.h"
#include "base/require.h"
#include "foreign/frame_message.h"
#include "foreign/presets.h"
#include "wire/rgbd_frame.h"

namespace vismap {
namespace {

/// All channels of a log; its data is not read.
Result<std::set<std::string>> ReadChannels(const std::string& path) {
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) return tl::unexpected(reader.error());
  std::set<std::string> channels;
  const Result<void> read = ForEachEvent(
      *reader,
      [&](const LogEvent& event) -> Result<void> {
        channels.insert(event.channel);
        return {};
      },
      [](const LogDamage&) {});
  if (!read) return tl::unexpected(read.error());
  return channels;
}

std::string ListText(const std::set<std::string>& names) {
  constexpr size_t kMost = 30;
  std::string text;
  size_t shown = 0;
  for (const std::string& name : names) {
    if (shown++ == kMost) return text + ", ...";
    text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "none" : text;
}

/// Sets the preset that fits the log, when the camera has none, and what the preset has.
Result<void> CompleteCamera(const std::string& path, const std::set<std::string>& channels,
                            AdapterCameraOptions* camera, std::vector<std::string>* remarks) {
  if (camera->preset == AdapterPreset::kAuto && camera->depth_channel.empty()) {
    camera->preset = FindPreset(channels);
    if (camera->preset == AdapterPreset::kAuto) {
      return Fail(path + ": no preset fits the channels of the log (" + ListText(channels) +
                  "); give adapter.depth_channel and the others with --config");
    }
    remarks->push_back(path + " is read with the preset " + NameOf(camera->preset) +
                       ", which fits its channels");
  }
  *camera = WithPreset(*camera);
  if (const auto complete = CheckComplete(*camera); !complete) {
    return Fail(path + ", preset " + NameOf(camera->preset) + ": " + complete.error().message +
                "; give it with --config FILE.txtpb");
  }
  if (std::none_of(channels.begin(), channels.end(), [&](const std::string& found) {
        return ChannelMatches(camera->depth_channel, found);
      })) {
    return Fail(path + ": the log has no channel " + camera->depth_channel +
                " (adapter.depth_channel); it has " + ListText(channels));
  }
  return {};
}

Result<std::vector<AdapterCameraOptions>> CamerasFor(const std::string& path,
                                                     const AdapterOptions& adapter,
                                                     std::vector<std::string>* remarks) {
  const Result<std::set<std::string>> channels = ReadChannels(path);
  if (!channels) return tl::unexpected(channels.error());
  std::vector<AdapterCameraOptions> cameras = CamerasOf(adapter);
  for (AdapterCameraOptions& camera : cameras) {
    if (const auto completed = CompleteCamera(path, *channels, &camera, remarks); !completed)
      return tl::unexpected(completed.error());
  }
  return cameras;
}

bool NamesChannel(const std::set<std::string>& patterns, const std::string& channel) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& pattern) { return ChannelMatches(pattern, channel); });
}

}  // namespace

Result<bool> HasForeignImages(const std::string& path, const AdapterOptions& adapter) {
  const Result<std::set<std::string>> channels = ReadChannels(path);
  if (!channels) return tl::unexpected(channels.error());
  return !adapter.camera.empty() || !adapter.depth_channel.empty() ||
         adapter.preset != AdapterPreset::kAuto || FindPreset(*channels) != AdapterPreset::kAuto;
}

Result<std::unique_ptr<ForeignDataset>> ForeignDataset::Open(const std::string& path,
                                                             const AdapterOptions& adapter,
                                                             const DatasetOptions& options) {
  std::vector<std::string> remarks;
  const Result<std::vector<AdapterCameraOptions>> cameras = CamerasFor(path, adapter, &remarks);
  if (!cameras) return tl::unexpected(cameras.error());
  Result<LogReader> reader = LogReader::Open(path);
  if (!reader) return tl::unexpected(reader.error());
  std::unique_ptr<ForeignDataset> dataset(new ForeignDataset(std::move(*reader), *cameras));
  dataset->remarks_ = std::move(remarks);
  if (const Result<void> scanned = dataset->Scan(options); !scanned)
    return tl::unexpected(scanned.error());
  return dataset;
}

// Reads the whole log once and joins its messages.
Result<void> ForeignDataset::Scan(const DatasetOptions& options) {
  Result<CameraJoiners> joiners = CameraJoiners::Create(
      cameras_,
      [&](size_t camera, ForeignFrame&& frame) { Keep(camera, std::move(frame), options); }, false);
  if (!joiners) return Fail(reader_.path() + ": " + joiners.error().message);
  std::set<std::string> patterns, image_patterns;
  for (const AdapterCameraOptions& camera : cameras_) {
    patterns.merge(ChannelsOf(camera));
    image_patterns.insert({camera.color_channel, camera.depth_channel});
  }
  int64_t damaged = 0;
  const Result<void> read = ForEachEvent(
      reader_,
      [&](const LogEvent& event) -> Result<void> {
        if (!NamesChannel(patterns, event.channel)) return {};
        const Result<std::vector<uint8_t>> bytes = reader_.ReadData(event);
        if (!bytes) return tl::unexpected(bytes.error());
        const bool has_images = NamesChannel(image_patterns, event.channel);
        if (has_images) images_.push_back(event);
        const int64_t number = has_images ? std::ssize(images_) - 1 : -1;
        (void)joiners->Add(event.channel, *bytes, event.timestamp, number);  // counts what fails
        return {};
      },
      [&](const LogDamage&) { ++damaged; });
  if (!read) return tl::unexpected(read.error());
  joiners->Finish();
  for (size_t i = 0; i < cameras_.size(); ++i)
    cameras_[i] = joiners->cameras()[i].options();  // with the channels that a * stood for
  if (frames_.empty()) {
    if (cameras_.size() > 1)
      return Fail(reader_.path() + ": no usable frames (" + joiners->DroppedText() + ")");
    const ReasonCounts& dropped = joiners->cameras().front().dropped();
    return Fail(reader_.path() + ": " + NoUsableFramesText(dropped, dropped.total()));
  }
  AddRemarks(*joiners, damaged);
  return {};
}

void ForeignDataset::AddRemarks(const CameraJoiners& joiners, int64_t damaged) {
  if (joiners.dropped() > 0) remarks_.push_back("not used: " + joiners.DroppedText());
  if (joiners.ignored() > 0) remarks_.push_back("ignored: " + joiners.IgnoredText());
  if (damaged > 0)
    remarks_.push_back(reader_.path() + " has " + FormatCount(damaged, "damaged part"));
  for (size_t i = 0; i < cameras_.size(); ++i) {
    const auto first = std::find_if(frames_.begin(), frames_.end(),
                                    [&](const Frame& frame) { return frame.camera == i; });
    if (first == frames_.end()) {
      remarks_.push_back(CameraName(cameras_[i]) + " has no usable frames");
      continue;
    }
    remarks_.push_back(CameraName(cameras_[i]) + ": " + CameraText(first->header.camera) +
                       ": from " +
                       (cameras_[i].intrinsics.empty() ? cameras_[i].intrinsics_channel
                                                       : std::string("adapter.intrinsics")));
  }
}

void ForeignDataset::Keep(size_t camera, ForeignFrame joined, const DatasetOptions& options) {
  const int64_t number = found_++;
  const bool chosen =
      number % options.stride == 0 &&
      (options.max_frames == 0 || frames_.size() < static_cast<size_t>(options.max_frames));
  if (!chosen) return;
  const rgbd_frame_t message = ToMessage(ForeignFrame(joined), cameras_[camera]);
  Result<FrameHeader> header = DecodeHeader(message);
  if (!header) {
    skipped_.push_back({number, header.error().message});
    return;
  }
  frames_.push_back({camera, std::move(joined), *header});
}

std::string ForeignDataset::name() const {
  return std::filesystem::path(reader_.path()).filename().string();
}

FrameHeader ForeignDataset::Header(size_t i) const {
  Require(i < size(), "the index of a frame is below the number of frames");
  return frames_[i].header;
}

// Reads the colour or the depth image of a message again.
Result<ForeignMessage> ForeignDataset::MessageAt(int64_t number, ImageRole role, bool is_color,
                                                 const AdapterCameraOptions& camera) const {
  const LogEvent& event = images_[static_cast<size_t>(number)];
  const Result<std::vector<uint8_t>> bytes = reader_.ReadData(event);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<ForeignMessage> message = DecodeForeign(
      *bytes, event.channel, {role, camera.root, camera.body_frame, "", is_color, !is_color});
  if (!message) {
    return Fail(reader_.path() + ", " + event.channel + " at byte " + std::to_string(event.offset) +
                ": " + message.error().message);
  }
  return message;
}

// Sets the pixels of an image that was joined without them.
Result<void> ForeignDataset::ReadPixels(const AdapterCameraOptions& camera, bool is_color,
                                        ForeignImage* image) const {
  const bool own_channel = camera.color_channel != camera.depth_channel;
  const ImageRole role = !is_color && own_channel ? ImageRole::kDepth : ImageRole::kColor;
  Result<ForeignMessage> message = MessageAt(image->message, role, is_color, camera);
  if (!message) return tl::unexpected(message.error());
  std::optional<ForeignImage>& found = is_color ? message->color : message->depth;
  if (!found) return Fail(reader_.path() + ": an image changed while the log was read");
  Result<ForeignImage> corrected = Corrected(std::move(*found), is_color, camera);
  if (!corrected) return Fail(reader_.path() + ": " + corrected.error().message);
  image->format = corrected->format;
  image->bytes = std::move(corrected->bytes);
  return {};
}

Result<rgbd_frame_t> ForeignDataset::Message(size_t i) const {
  ForeignFrame joined = frames_[i].joined;
  const AdapterCameraOptions& camera = cameras_[frames_[i].camera];
  if (const auto read = ReadPixels(camera, false, &joined.depth); !read)
    return tl::unexpected(read.error());
  if (joined.color) {
    if (const auto read = ReadPixels(camera, true, &*joined.color); !read)
      return tl::unexpected(read.error());
  }
  return ToMessage(std::move(joined), camera);
}

Result<SensorFrame> ForeignDataset::Read(size_t i) const {
  Require(i < size(), "the index of a frame is below the number of frames");
  const Result<rgbd_frame_t> message = Message(i);
  if (!message) return tl::unexpected(message.error());
  Result<SensorFrame> frame = Decode(*message);
  if (!frame) return Fail(reader_.path() + ": " + frame.error().message);
  return frame;
}

}  // namespace vismap
