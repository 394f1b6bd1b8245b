#include "wire/camera_sources.h"

namespace vismap {
namespace {

constexpr size_t kReturnsOfTwins = 3;
constexpr const char* kPhrase = " is published by more than one process, ";

}  // namespace

std::optional<std::string> CameraSources::Add(CameraId camera, const std::string& source,
                                              int64_t seq, double now) {
  const auto known = heard_.find(camera);
  if (known != heard_.end()) ForgetSilent(now, &known->second);
  const bool is_new = known == heard_.end() || !known->second.contains(source);
  if (is_new && size_ >= kMaxSources) ForgetAllSilent(now);
  if (is_new && size_ >= kMaxSources) return std::nullopt;
  size_ += is_new ? 1 : 0;
  Sources& sources = heard_[camera];
  Source& of_source = sources[source];
  const bool twins = AddNumber(seq, now, &of_source);
  if (sources.size() < 2 && !twins) return std::nullopt;
  std::string names = twins ? "'" + source + "' (twice)" : "";
  for (const auto& [name, unused] : sources) {
    if (!twins || name != source) names += (names.empty() ? "'" : ", '") + name + "'";
  }
  return "camera " + std::to_string(Raw(camera)) + kPhrase + names +
         ": of frames with equal utimes only one is mapped; give each process a camera id of its "
         "own (--camera-id)";
}

// Whether the numbers of this source are those of two processes. Such numbers fall when the second
// process comes in, and then go on above the fallen one when the first comes in again, over and
// over. The numbers of a process that is restarted fall, too, but do not go back to the old ones.
bool CameraSources::AddNumber(int64_t seq, double now, Source* source) {
  if (seq <= source->seq) {
    source->fell_from = source->seq;
    source->fell_to_itself = seq == source->seq;
  } else if (source->fell_from && seq > *source->fell_from) {
    if (source->seq < *source->fell_from || source->fell_to_itself) source->returns.push_back(now);
    source->fell_from.reset();
  }
  source->seq = seq;
  source->last_heard = now;
  while (!source->returns.empty() && now - source->returns.front() > kMemoryOfReturns)
    source->returns.pop_front();
  if (source->returns.size() > kReturnsOfTwins) source->returns.pop_front();
  return source->returns.size() >= kReturnsOfTwins;
}

void CameraSources::ForgetSilent(double now, Sources* sources) {
  size_ -= std::erase_if(
      *sources, [&](const auto& entry) { return now - entry.second.last_heard > kSilence; });
}

void CameraSources::ForgetAllSilent(double now) {
  for (auto& [camera, sources] : heard_) ForgetSilent(now, &sources);
  std::erase_if(heard_, [](const auto& entry) { return entry.second.empty(); });
}

bool IsAboutSharedCamera(const std::string& finding, const std::string& source) {
  return finding.find(kPhrase) != std::string::npos &&
         finding.find("'" + source + "'") != std::string::npos;
}

}  // namespace vismap
