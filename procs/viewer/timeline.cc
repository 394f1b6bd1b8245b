#include "viewer/timeline.h"

#include <nlohmann/json.hpp>

namespace vismap {

std::string TimelineText(const LogRecording& recording) {
  using TimelineJson = nlohmann::ordered_json;
  const RecordingState state = recording.state();
  TimelineJson json{{"kind", "timeline"},          {"total", state.total},
                    {"read", state.read},          {"mapped", state.mapped},
                    {"done", state.done},          {"message", state.message},
                    {"stride", recording.stride()}};
  json["frames"] = json["utimes"] = json["marks"] = TimelineJson::array();
  int64_t before = 0;
  for (const Moment& moment : recording.moments()) {
    json["frames"].push_back(moment.frames);
    json["utimes"].push_back(moment.utime - before);
    before = moment.utime;
  }
  for (const ObjectMark& mark : recording.marks()) {
    json["marks"].push_back({{"frames", mark.frames},
                             {"utime", mark.utime},
                             {"id", mark.id},
                             {"name", mark.name},
                             {"appeared", mark.appeared}});
  }
  return json.dump(-1, ' ', false, TimelineJson::error_handler_t::replace);
}

}  // namespace vismap
