#include "foreign/camera_joiners.h"

#include <utility>

#include "foreign/presets.h"

namespace vismap {
namespace {

template <typename Figure>
int64_t SumOver(const std::vector<FrameJoiner>& joiners, const Figure& figure) {
  int64_t sum = 0;
  for (const FrameJoiner& joiner : joiners) sum += figure(joiner);
  return sum;
}

}  // namespace

std::string CameraName(const AdapterCameraOptions& camera) {
  return "camera " + std::to_string(camera.camera_id);
}

Result<CameraJoiners> CameraJoiners::Create(const std::vector<AdapterCameraOptions>& cameras,
                                            const Sink& sink, bool keep_pixels) {
  if (const Result<void> complete = CheckComplete(cameras); !complete)
    return tl::unexpected(complete.error());
  CameraJoiners made;
  for (size_t i = 0; i < cameras.size(); ++i) {
    const auto hand_on = [sink, i](ForeignFrame&& frame) { sink(i, std::move(frame)); };
    Result<FrameJoiner> joiner = FrameJoiner::Create(cameras[i], hand_on, keep_pixels);
    if (!joiner) return tl::unexpected(joiner.error());
    made.joiners_.push_back(std::move(*joiner));
  }
  return made;
}

Result<void> CameraJoiners::Add(const std::string& channel, std::span<const uint8_t> bytes,
                                int64_t received, int64_t number) {
  Result<void> result;
  for (FrameJoiner& joiner : joiners_) {
    const Result<void> added = joiner.Add(channel, bytes, received, number);
    if (!added) result = added;
  }
  return result;
}

void CameraJoiners::Advance(int64_t now) {
  for (FrameJoiner& joiner : joiners_) joiner.Advance(now);
}

void CameraJoiners::Finish() {
  for (FrameJoiner& joiner : joiners_) joiner.Finish();
}

void CameraJoiners::SetWallOffset(int64_t offset) {
  for (FrameJoiner& joiner : joiners_) joiner.SetWallOffset(offset);
}

int64_t CameraJoiners::frames() const {
  return SumOver(joiners_, [](const FrameJoiner& joiner) { return joiner.frames(); });
}

int64_t CameraJoiners::waiting() const {
  return SumOver(joiners_, [](const FrameJoiner& joiner) { return joiner.waiting(); });
}

int64_t CameraJoiners::dropped() const {
  return SumOver(joiners_, [](const FrameJoiner& joiner) { return joiner.dropped().total(); });
}

int64_t CameraJoiners::ignored() const {
  return SumOver(joiners_, [](const FrameJoiner& joiner) { return joiner.ignored().total(); });
}

std::string CameraJoiners::DroppedText() const { return TextOf(&FrameJoiner::dropped); }

std::string CameraJoiners::IgnoredText() const { return TextOf(&FrameJoiner::ignored); }

std::string CameraJoiners::TextOf(Counts counts) const {
  std::string text;
  for (const FrameJoiner& joiner : joiners_) {
    const ReasonCounts& reasons = (joiner.*counts)();
    if (reasons.total() == 0) continue;
    text += text.empty() ? "" : "; ";
    if (joiners_.size() > 1) text += CameraName(joiner.options()) + ": ";
    text += reasons.Text();
  }
  return text;
}

}  // namespace vismap
