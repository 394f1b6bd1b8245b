#include "doctor/findings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/format.h"
#include "runtime/version.h"
#include "wire/channels.h"
#include "wire/fingerprint.h"

namespace vismap {
namespace {

// A longer time without STATUS, which is published every second, is a problem [s].
constexpr double kSilence = 3;
constexpr double kClockTolerance = 1;  // [s]

bool EndsWith(const std::string& name, const std::string& end) {
  return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

/// Collects the findings; each function finds problems of one kind.
class Diagnosis {
 public:
  Diagnosis(const Listening& listening, const BusPicture& picture)
      : listening_(listening), picture_(picture) {}

  std::vector<Finding> Make() && {
    for (const CheckResult& check : listening_.checks) {
      if (!check.ok) Add(check.what + ": " + check.found, "");
    }
    if (!findings_.empty() && picture_.channels().empty()) return std::move(findings_);
    if (picture_.channels().empty()) {
      Add("no message was received in " + Observed() + ", so no process is on the bus",
          "start the processes with --lcm-url " + listening_.lcm_url);
      return std::move(findings_);
    }
    OtherPrefixes();
    FlowOfFrames();
    for (const auto& [name, process] : picture_.processes()) OneProcess(name, process);
    for (const auto& [name, channel] : picture_.channels()) OneChannel(name, channel);
    for (const auto& [id, camera] : picture_.cameras()) Lag(id, camera);
    SeveralServers();
    return std::move(findings_);
  }

 private:
  void Add(const std::string& what, const std::string& todo) { findings_.push_back({what, todo}); }
  bool Flows(const Channel& channel) const { return picture_.messages(channel.name) > 0; }
  std::string Observed() const { return FormatDuration(listening_.seconds); }
  std::string NoneOf(const Channel& channel) const {
    return "no " + std::string(channel.name) + " was received in " + Observed();
  }

  // Another pipeline may run beside a complete one of this prefix.
  bool PipelineIsComplete() const {
    const bool frames = Flows(kRgbdFrameChannel) || Flows(kSegmentedFrameChannel);
    return picture_.Has("map-server") && frames && !SegmenterWaits();
  }

  void OtherPrefixes() {
    if (PipelineIsComplete()) return;
    std::set<std::string> told;
    for (const auto& [name, channel] : picture_.channels()) {
      if (channel.type_of_ours.empty() || !told.insert(channel.other_prefix).second) continue;
      Add("channel " + name + " carries " + channel.type_of_ours + ", a type of vismap, but this " +
              "doctor uses the prefix '" + picture_.channel_prefix() + "' for vismap's channels",
          "give all processes of a pipeline and vismap-doctor one prefix; for this one, "
          "--channel-prefix '" +
              channel.other_prefix + "'");
    }
  }

  // Follows a frame through the pipeline and reports the first stage that it does not pass.
  void FlowOfFrames() {
    if (!picture_.Has("map-server")) {
      Add("no map server is on the bus, so no map is built", "start vismap-map-server");
    }
    if (!Flows(kRgbdFrameChannel) && !Flows(kSegmentedFrameChannel)) {
      if (picture_.Has("sensor-replay")) {
        Add(NoneOf(kRgbdFrameChannel) + ", although a sensor-replay is on the bus",
            "its state below says whether it waits or has ended");
      } else {
        Add(NoneOf(kRgbdFrameChannel),
            "start vismap-sensor-replay or the publisher of your camera");
      }
      return;  // without frames, the later stages have nothing to do
    }
    if (!Flows(kSegmentedFrameChannel)) {
      if (!picture_.Has("depth-segmenter")) {
        Add("no depth-segmenter is on the bus, so frames are not segmented",
            "start vismap-depth-segmenter");
      } else if (!Flows(kDetectionsChannel) && SegmenterWaits()) {
        Add("depth-segmenter waits for DETECTIONS, but " + NoneOf(kDetectionsChannel),
            "start vismap-detector, or run vismap-depth-segmenter with --detections none");
      } else {
        Add(NoneOf(kSegmentedFrameChannel) +
                ", although frames arrive and a depth-segmenter is on the bus",
            "see its state and its rejected messages below");
      }
    } else if (!Flows(kMapCommitChannel) && picture_.Has("map-server")) {
      Add(NoneOf(kMapCommitChannel) +
              ", although segmented frames arrive and a map server is on the bus",
          "see its state and its rejected messages below");
    }
  }

  bool SegmenterWaits() const {
    return std::any_of(picture_.processes().begin(), picture_.processes().end(),
                       [](const auto& entry) {
                         return entry.second.last.process == "depth-segmenter" &&
                                entry.second.last.message.find("DETECTIONS") != std::string::npos;
                       });
  }

  void OneProcess(const std::string& name, const ProcessPicture& process) {
    const process_status_t& status = process.last;
    const std::string who = name + " on " + status.host;
    if (status.types_fingerprint != TypesFingerprint()) {
      Add(who + " uses other message types (version " + status.version +
              ") than this computer (version " + Version() + "), so they cannot exchange messages",
          "install the same version on both");
    } else if (status.version != Version()) {
      Add(who + " has version " + status.version + ", but this computer has version " + Version(),
          "install the same version on both");
    }
    if (!process.places.empty()) {
      std::string places;
      for (const std::string& place : process.places)
        places += (places.empty() ? "" : "; ") + place;
      Add("two processes have the name " + name + " (" + places + ")",
          "give one of them another name with --name");
    }
    // A hub may deliver the last STATUS of a process that has ended late.
    if (status.state != "stopping" && std::abs(process.clock_difference) > kClockTolerance) {
      Add("the clock of " + status.host + " is " +
              FormatDuration(std::abs(process.clock_difference)) +
              (process.clock_difference > 0 ? " ahead of" : " behind") +
              " the clock of this computer",
          "synchronise both clocks: sudo apt-get install chrony");
    }
    const double silence = listening_.now - process.last_heard;
    if (silence > kSilence && status.state != "stopping") {
      Add(who + " has published no STATUS for " + FormatDuration(silence),
          "check whether the process with pid " + std::to_string(status.pid) + " still runs");
    }
    if (process.restarts > 0) {
      Add(who + " was restarted " + FormatCount(process.restarts, "time") + " in " + Observed(),
          "its log says why");
    }
    State(who, status);
    for (const std::string& finding : status.findings) Add(who + ": " + finding, "");
    Losses(who, process);
  }

  void State(const std::string& who, const process_status_t& status) {
    const bool is_finding = std::find(status.findings.begin(), status.findings.end(),
                                      status.message) != status.findings.end();
    const bool told = status.message.empty() || is_finding ||
                      (status.process == "depth-segmenter" && !Flows(kDetectionsChannel) &&
                       !Flows(kSegmentedFrameChannel) && SegmenterWaits());
    if (told) return;
    if (status.state == "waiting" || status.state == "starting" || status.process == "hub") {
      Add(who + ": " + status.message, "");
    }
  }

  // Messages that a process has lost, dropped, rejected or could not send while the bus was
  // observed.
  void Losses(const std::string& who, const ProcessPicture& process) {
    static const struct {
      const char* end;
      const char* text;
      const char* todo;
    } kinds[] = {
        {"dropped", "dropped",
         "its readers are too slow, or a bus was unreachable; its log has more"},
        {".lost", "did not receive",
         "find the process that dropped them; on udpm check the receive buffer"},
        {".rejected", "rejected", "its log says why"},
        {".unsent", "could not send", "check its connection to the bus"},
        {"dropped_on_purpose", "dropped intentionally", "start vismap-hub without --drop-fraction"},
    };
    for (const std::string& counter : process.last.counter_names) {
      const int64_t more = CounterOf(process.last, counter) - CounterOf(process.first, counter);
      if (more <= 0) continue;
      for (const auto& kind : kinds) {
        if (counter != kind.end && !EndsWith(counter, kind.end)) continue;
        Add(who + " " + kind.text + " " + FormatCount(more, "message") + " in " + Observed() +
                " (" + counter + ", " + FormatCount(CounterOf(process.last, counter)) +
                " in total)",
            kind.todo);
      }
    }
  }

  void OneChannel(const std::string& name, const ChannelPicture& channel) {
    if (channel.foreign > 0) {
      Add(name + ": " + FormatCount(channel.foreign) + " of " +
              FormatCount(channel.messages, "message") +
              " have a wrong type or another version of the type",
          "find the process that publishes them; all processes must be built from the same "
          "lcmtypes");
    }
    if (channel.gaps > 0) {
      Add(name + ": " + FormatCount(channel.gaps, "message") + " of the sequence were not received",
          "find the process that dropped them");
    }
  }

  void Lag(int32_t id, const CameraPicture& camera) {
    // A gap between two frames of a recording is no lag.
    constexpr double kShortest = 1;  // [s]
    const double lag = camera.Lag(), more = lag - camera.first_lag;
    if (camera.behind_since < 0 || listening_.now - camera.behind_since < kShortest) return;
    std::string text = "the map is " + FormatDuration(lag) + " behind camera " + std::to_string(id);
    if (more > 0.1 * listening_.seconds)
      text += ", and fell " + FormatDuration(more) + " further behind in " + Observed();
    Add(text,
        "the processes are slower than the camera: send fewer frames, or set overload: NEWEST "
        "in depth_segmenter and map_server, so that they drop the oldest ones");
  }

  void SeveralServers() {
    std::string names;
    int count = 0;
    for (const auto& [name, process] : picture_.processes()) {
      if (process.last.process != "map-server" || process.last.state == "stopping") continue;
      names += (count++ > 0 ? ", " : "") + name;
    }
    if (count > 1) Add("more than one map server is on the bus: " + names, "stop all but one");
  }

  const Listening& listening_;
  const BusPicture& picture_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> Diagnose(const Listening& listening, const BusPicture& picture) {
  return Diagnosis(listening, picture).Make();
}

}  // namespace vismap
