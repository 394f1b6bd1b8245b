#include "wire/camera_sources.h"

namespace vismap {
namespace {

constexpr int kStepsOfTwins = 3;
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
  of_source.steps_back += seq <= of_source.seq ? 1 : 0;
  of_source.seq = seq;
  of_source.last_heard = now;
  const bool twins = of_source.steps_back >= kStepsOfTwins;
  if (sources.size() < 2 && !twins) return std::nullopt;
  std::string names = twins ? "'" + source + "' (twice)" : "";
  for (const auto& [name, unused] : sources) {
    if (!twins || name != source) names += (names.empty() ? "'" : ", '") + name + "'";
  }
  return "camera " + std::to_string(Raw(camera)) + kPhrase + names +
         ": of frames with equal utimes only one is mapped; give each process a camera id of its "
         "own (--camera-id)";
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
