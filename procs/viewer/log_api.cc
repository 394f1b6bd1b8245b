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

LogApi::LogApi(const LogSource* source, const OccupancyOptions& options, size_t max_map_bytes)
    : recording_(&source->recording()),
      options_(options),
      maps_(
          recording_,
          [source](int64_t frames, const std::atomic<bool>* stop) {
            return source->MapAfter(frames, stop);
          },
          max_map_bytes) {}

void LogApi::Get(HttpTarget target, const WebHandler::Reply& reply) {
  const Result<int64_t> frames = TakeFrames(&target);
  if (!frames) return reply(ErrorAnswer(400, frames.error().message));
  const std::string& path = target.path;
  if (path == "/api/timeline") return reply(JsonAnswer(TimelineText(*recording_)));
  const std::optional<Moment> moment = recording_->MomentAt(*frames);
  if (!moment) return reply(ErrorAnswer(503, "no frame of the log is mapped yet; try again"));
  if (path == "/api/map")
    return reply(JsonAnswer(MapText(SummaryOf(*recording_, *moment), 0, false)));
  if (path == "/api/objects") return reply(GetObjects(moment->frames));
  if (path == "/api/cell") return GetCell(target, moment->frames, reply);
  if (path == "/api/slice") return reply(GetSlice(target, *moment));
  reply(ErrorAnswer(404, "there is no '" + PrintableText(path, 100) +
                             "' for a log; there are /api/timeline, /api/map, /api/objects, "
                             "/api/slice?axis=z&at=1.0 and /api/cell?at=x,y,z, each of them with "
                             "&frames=N for the map after so many frames"));
}

HttpAnswer LogApi::GetObjects(int64_t frames) const {
  const Result<std::string> json = recording_->ObjectsJsonAt(frames);
  if (!json) return ErrorAnswer(500, json.error().message);
  if (json->empty()) return ErrorAnswer(503, "no objects are listed yet; try again");
  return JsonAnswer(*json);
}

void LogApi::GetCell(const HttpTarget& target, int64_t frames, const WebHandler::Reply& reply) {
  if (target.query.size() != 1 || !target.query.contains("at"))
    return reply(ErrorAnswer(400, "cell: say where with at=x,y,z [m]"));
  const Result<std::vector<double>> at = ReadNumbersOf("at", target.query.at("at"), 3);
  if (!at) return reply(ErrorAnswer(400, "cell: " + at.error().message));
  if (recording_->CopyAt(frames) == nullptr)
    return reply(ErrorAnswer(503, "too few frames are mapped yet; try again"));
  const CellQuestion question{
      {(*at)[0], (*at)[1], (*at)[2]}, frames, MonotonicSeconds() + kLongestWait, reply};
  if (Answer(question)) return;
  if (waiting_.size() >= kMostWaiting)
    return reply(ErrorAnswer(429, "too many questions wait for maps that are being computed"));
  waiting_.push_back(question);
}

bool LogApi::Answer(const CellQuestion& question) {
  const Result<MomentMaps::MapPtr> made = maps_.Get(question.frames);
  if (!made) {
    question.reply(ErrorAnswer(500, made.error().message));
    return true;
  }
  const MomentMaps::MapPtr& map = *made;
  if (map == nullptr && MonotonicSeconds() < question.give_up) return false;
  if (map == nullptr) {
    question.reply(ErrorAnswer(503, "the map at this moment is being computed; try again"));
    return true;
  }
  const Result<std::string> json =
      ExplainCell(map->map, map->metadata, options_, question.at_W, ClassName);
  question.reply(json ? JsonAnswer(*json) : ErrorAnswer(400, "cell: " + json.error().message));
  return true;
}

void LogApi::Poll() {
  std::erase_if(waiting_, [this](const CellQuestion& question) { return Answer(question); });
}

HttpAnswer LogApi::GetSlice(const HttpTarget& target, const Moment& moment) {
  const auto question = ReadSlice(target);
  if (!question) return ErrorAnswer(400, question.error().message);
  const auto space = [&]() -> tl::expected<const OccupancyMap*, HttpAnswer> {
    const Result<const OccupancyMap*> found = SpaceAt(moment);
    if (!found) return tl::unexpected(ErrorAnswer(500, found.error().message));
    return *found;
  };
  const FollowerPosition position{recording_->map_id(), moment.frames};
  const auto found =
      slices_.Find(*question, recording_->voxel_size_m(), space, position, MonotonicSeconds());
  if (!found) return found.error();
  const std::string problem =
      AsksForDistances(target) ? "the viewer of a log knows no distances" : "";
  return {200, "application/octet-stream",
          EncodeSlice(**found, *question, position, nullptr, problem), ""};
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
