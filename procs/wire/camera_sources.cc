#include "wire/camera_sources.h"

namespace vismap {
namespace {

constexpr int kStepsOfTwins = 3;
constexpr const char* kPhrase = " is published by more than one process, ";

}  // namespace

std::optional<std::string> CameraSources::Add(CameraId camera, const std::string& source,
                                              int64_t seq, double now) {
  std::map<std::string, Source>& sources = heard_[camera];
  size_ -= std::erase_if(
      sources, [&](const auto& entry) { return now - entry.second.last_heard > kSilence; });
  if (!sources.contains(source)) {
    if (size_ >= kMaxSources) return std::nullopt;
    ++size_;
  }
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

bool IsAboutSharedCamera(const std::string& finding, const std::string& source) {
  return finding.find(kPhrase) != std::string::npos &&
         finding.find("'" + source + "'") != std::string::npos;
}

}  // namespace vismap
