#include "viewer/log_api.h"

#include <charconv>
#include <utility>

#include "base/class_names.h"
#include "base/printable.h"
#include "exports/explain_cell.h"
#include "requests/request_argument.h"
#include "runtime/clock.h"
#include "viewer/page_moment.h"
#include "viewer/timeline.h"

namespace vismap {
namespace {

constexpr size_t kMostSpaces = 3;  // maps of free space that are kept

// Takes frames=N out of the arguments; the newest moment without it.
Result<int64_t> TakeFrames(HttpTarget* target) {
  const auto found = target->query.find("frames");
  if (found == target->query.end()) return INT64_MAX;
  const std::string text = found->second;
  target->query.erase(found);
  int64_t frames = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frames);
  if (error != std::errc() || end != text.data() + text.size() || frames < 0)
    return Fail("frames: expected a number of frames, found '" + PrintableText(text, 60) + "'");
  return frames;
}

}  // namespace

HttpAnswer LogApi::Get(HttpTarget target) {
  const Result<int64_t> frames = TakeFrames(&target);
  if (!frames) return ErrorAnswer(400, frames.error().message);
  const std::string& path = target.path;
  if (path == "/api/timeline") return JsonAnswer(TimelineText(*recording_));
  const std::optional<Moment> moment = recording_->MomentAt(*frames);
  if (!moment) return ErrorAnswer(503, "no frame of the log is mapped yet; try again");
  if (path == "/api/map") {
    PageMoment surface(recording_);
    surface.Show(*moment);
    return JsonAnswer(MapText(surface.Summary(), 0, false));
  }
  if (path == "/api/objects") return GetObjects(moment->frames);
  if (path == "/api/cell") return GetCell(target, moment->frames);
  if (path == "/api/slice") return GetSlice(target, *moment);
  return ErrorAnswer(404, "there is no '" + PrintableText(path, 100) +
                              "' for a log; there are /api/timeline, /api/map, /api/objects, "
                              "/api/slice?axis=z&at=1.0 and /api/cell?at=x,y,z, each of them with "
                              "&frames=N for the map after so many frames");
}

HttpAnswer LogApi::GetObjects(int64_t frames) const {
  const Result<std::string> json = recording_->ObjectsJsonAt(frames);
  if (!json) return ErrorAnswer(500, json.error().message);
  if (json->empty()) return ErrorAnswer(503, "no objects are listed yet; try again");
  return JsonAnswer(*json);
}

HttpAnswer LogApi::GetCell(const HttpTarget& target, int64_t frames) const {
  if (target.query.size() != 1 || !target.query.contains("at"))
    return ErrorAnswer(400, "cell: say where with at=x,y,z [m]");
  const Result<std::vector<double>> at = ReadNumbersOf("at", target.query.at("at"), 3);
  if (!at) return ErrorAnswer(400, "cell: " + at.error().message);
  const std::shared_ptr<const LoadedMap> copy = recording_->CopyAt(frames);
  if (copy == nullptr) return ErrorAnswer(503, "too few frames are mapped yet; try again");
  const Result<std::string> json =
      ExplainCell(copy->map, copy->metadata, options_, {(*at)[0], (*at)[1], (*at)[2]}, ClassName);
  if (!json) return ErrorAnswer(400, "cell: " + json.error().message);
  return JsonAnswer(*json);
}

HttpAnswer LogApi::GetSlice(const HttpTarget& target, const Moment& moment) {
  if (const auto question = ReadSlice(target); !question)
    return ErrorAnswer(400, question.error().message);
  const Result<const OccupancyMap*> space = SpaceAt(moment);
  if (!space) return ErrorAnswer(500, space.error().message);
  return slices_.Get(target, **space, {recording_->map_id(), moment.frames}, MonotonicSeconds());
}

Result<const OccupancyMap*> LogApi::SpaceAt(const Moment& moment) {
  for (const Space& space : spaces_) {
    if (space.frames == moment.frames && space.thinnings == recording_->thinnings())
      return &space.map;
  }
  const int64_t thinnings = recording_->thinnings();
  Result<OccupancyMap> map = recording_->SpaceAt(moment.frames);
  if (!map) return tl::unexpected(map.error());
  spaces_.push_front({moment.frames, thinnings, std::move(*map)});
  if (spaces_.size() > kMostSpaces) spaces_.pop_back();
  return &spaces_.front().map;
}

}  // namespace vismap
