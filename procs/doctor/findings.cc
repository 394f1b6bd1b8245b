#include "doctor/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "runtime/version.h"
#include "wire/channels.h"
#include "wire/fingerprint.h"

namespace vismap {
namespace {

constexpr double kSilence = 3;         // without a status; they come every second [s]
constexpr double kClockTolerance = 1;  // [s]

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g s", seconds);
  return text;
}

bool EndsWith(const std::string& name, const std::string& end) {
  return name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

/// Fills in findings, one kind of them per function.
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
      Add("nobody is on the bus: not one message in " + Seconds(listening_.seconds),
          "start the processes with --lcm-url " + listening_.lcm_url);
      return std::move(findings_);
    }
    FlowOfFrames();
    for (const auto& [name, process] : picture_.processes()) OneProcess(name, process);
    for (const auto& [name, channel] : picture_.channels()) OneChannel(name, channel);
    SeveralServers();
    return std::move(findings_);
  }

 private:
  void Add(const std::string& what, const std::string& todo) { findings_.push_back({what, todo}); }
  bool Flows(const Channel& channel) const { return picture_.messages(channel.name) > 0; }
  std::string NoneOf(const Channel& channel) const {
    return std::string(channel.name) + ": none in " + Seconds(listening_.seconds);
  }

  // Along the way of a frame, the first place where it ends.
  void FlowOfFrames() {
    if (!picture_.Has("map-server")) {
      Add("no map server is on the bus: nothing makes a map", "start vismap-map-server");
    }
    if (!Flows(kRgbdFrameChannel) && !Flows(kSegmentedFrameChannel)) {
      if (picture_.Has("sensor-replay")) {
        Add(NoneOf(kRgbdFrameChannel) + ", though a sensor-replay is on the bus",
            "see below what it waits for, or whether it has ended");
      } else {
        Add(NoneOf(kRgbdFrameChannel), "start vismap-sensor-replay, or your camera's publisher");
      }
      return;
    }
    if (!Flows(kSegmentedFrameChannel)) {
      if (!picture_.Has("depth-segmenter")) {
        Add("nobody segments the frames", "start vismap-depth-segmenter");
      } else if (!Flows(kDetectionsChannel) && SegmenterWaits()) {
        Add("depth-segmenter waits for DETECTIONS: none in " + Seconds(listening_.seconds),
            "start vismap-detector, or run vismap-depth-segmenter with --detections none");
      } else {
        Add(NoneOf(kSegmentedFrameChannel) + ", though frames come and a segmenter is there",
            "see its state and what it rejected below");
      }
    } else if (!Flows(kMapCommitChannel) && picture_.Has("map-server")) {
      Add(NoneOf(kMapCommitChannel) + ", though segmented frames come and a map server is there",
          "see its state and what it rejected below");
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
      Add(who + " has other message types than this computer (version " + status.version +
              ", here " + Version() + "): they cannot understand each other",
          "install the same version on both");
    } else if (status.version != Version()) {
      Add(who + " has version " + status.version + ", here it is " + Version(),
          "install the same version on both");
    }
    if (!process.places.empty()) {
      std::string places;
      for (const std::string& place : process.places)
        places += (places.empty() ? "" : "; ") + place;
      Add("two processes are called " + name + " (" + places + ")",
          "give one of them another --name");
    }
    if (std::abs(process.clock_difference) > kClockTolerance) {
      Add("the clock of " + status.host + " is " + Seconds(std::abs(process.clock_difference)) +
              (process.clock_difference > 0 ? " ahead of" : " behind") + " this computer's",
          "let both run: sudo apt-get install chrony");
    }
    const double silence = listening_.now - process.last_heard;
    if (silence > kSilence && status.state != "stopping") {
      Add(who + " has been silent for " + Seconds(silence),
          "see whether pid " + std::to_string(status.pid) + " still runs");
    }
    if (process.restarts > 0) {
      Add(who + " was restarted " + std::to_string(process.restarts) + " times in " +
              Seconds(listening_.seconds),
          "see its log");
    }
    State(who, status);
    Losses(who, process);
  }

  void State(const std::string& who, const process_status_t& status) {
    const bool told = status.message.empty() ||
                      (status.process == "depth-segmenter" && !Flows(kDetectionsChannel) &&
                       !Flows(kSegmentedFrameChannel) && SegmenterWaits());
    if (told) return;
    if (status.state == "waiting" || status.state == "starting" || status.process == "hub") {
      Add(who + ": " + status.message, "");
    }
  }

  // What a process has lost, dropped, rejected or could not send, of late.
  void Losses(const std::string& who, const ProcessPicture& process) {
    static const struct {
      const char* end;
      const char* text;
      const char* todo;
    } kinds[] = {
        {"dropped", "dropped", "its readers are too slow, or a bus was away; see the log"},
        {".lost", "missed", "see who dropped them; on udpm see the receive buffer"},
        {".rejected", "rejected", "its log says why"},
        {".unsent", "could not send", "see the connection of its bus"},
        {"dropped_on_purpose", "dropped on purpose", "start vismap-hub without --drop-fraction"},
    };
    for (const std::string& counter : process.last.counter_names) {
      const int64_t more = CounterOf(process.last, counter) - CounterOf(process.first, counter);
      if (more <= 0) continue;
      for (const auto& kind : kinds) {
        if (counter != kind.end && !EndsWith(counter, kind.end)) continue;
        Add(who + " " + kind.text + " " + std::to_string(more) + " messages in " +
                Seconds(listening_.seconds) + " (" + counter + ", " +
                std::to_string(CounterOf(process.last, counter)) + " in all)",
            kind.todo);
      }
    }
  }

  void OneChannel(const std::string& name, const ChannelPicture& channel) {
    if (channel.foreign > 0) {
      Add(name + ": " + std::to_string(channel.foreign) + " of " +
              std::to_string(channel.messages) +
              " messages are of another type, or of another version of it",
          "find who publishes them; all must be built from the same lcmtypes");
    }
    if (channel.gaps > 0) {
      Add(name + ": " + std::to_string(channel.gaps) + " messages are missing in the sequence",
          "see who dropped them");
    }
  }

  void SeveralServers() {
    std::string names;
    int count = 0;
    for (const auto& [name, process] : picture_.processes()) {
      if (process.last.process != "map-server" || process.last.state == "stopping") continue;
      names += (count++ > 0 ? ", " : "") + name;
    }
    if (count > 1) Add("several map servers are on one bus: " + names, "stop all but one");
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
