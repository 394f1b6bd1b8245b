#include "map_tool/compare_runs.h"

#include <algorithm>
#include <map>
#include <optional>

#include "base/format.h"
#include "logs/recorded_run.h"

namespace vismap {
namespace {

std::string Place(size_t position, const frame_commit_t& commit) {
  return "frame " + std::to_string(position + 1) + " of the map (" + ToText(KeyOf(commit)) + "): ";
}

bool Integrates(const RunRecord& run, const FrameKey& key) {
  return std::any_of(run.history.integrated.begin(), run.history.integrated.end(),
                     [&](const frame_commit_t& commit) { return KeyOf(commit) == key; });
}

// Why the run `other` does not integrate this frame of run `in`; "" when it does.
std::string Absence(const RunRecord& in, const RunRecord& other, const FrameKey& key) {
  if (Integrates(other, key)) return "";
  const auto skipped = other.history.skipped.find(key);
  return "integrated in " + in.name + ", " +
         (skipped == other.history.skipped.end()
              ? "never committed in " + other.name
              : "skipped in " + other.name + " (" + skipped->second + ")");
}

// How two runs differ that integrate different frames, x and y, at the same position.
std::string OtherFrame(const RunRecord& a, const RunRecord& b, const frame_commit_t& x,
                       const frame_commit_t& y) {
  if (const std::string why = Absence(a, b, KeyOf(x)); !why.empty()) return why;
  if (const std::string why = Absence(b, a, KeyOf(y)); !why.empty()) {
    return b.name + " has another frame at this position (" + ToText(KeyOf(y)) + "), which is " +
           why;
  }
  return "the order differs: " + b.name + " has " + ToText(KeyOf(y)) + " at this position";
}

// How two runs differ in the same frame; "" = they do not differ.
std::string OtherResult(const RunRecord& a, const RunRecord& b, const frame_commit_t& x,
                        const frame_commit_t& y) {
  const bool x_had = x.had_detections, y_had = y.had_detections;
  if (x_had != y_had) {
    return "integrated with detections in " + (x_had ? a.name : b.name) + ", but without in " +
           (x_had ? b.name : a.name);
  }
  if (x.input_digest != y.input_digest) {
    return "the input differs (images, camera, pose or segments): the input digests are " +
           x.input_digest + " and " + y.input_digest;
  }
  if (x.digest != y.digest) {
    return "the input is the same, but the map was computed differently: the digests are " +
           x.digest + " and " + y.digest;
  }
  return "";
}

using Counts = std::map<FrameKey, std::vector<int>>;

// For every frame: the number of frames that had arrived before each of its messages.
Counts FramesBefore(const std::vector<Arrival>& arrivals) {
  Counts counts;
  int frames = 0;
  for (const Arrival& arrival : arrivals) {
    counts[arrival.frame].push_back(frames);
    if (arrival.channel == kRgbdFrameChannel.name) ++frames;
  }
  return counts;
}

std::string CompareArrivals(const RunRecord& a, const RunRecord& b) {
  if (a.arrivals == b.arrivals) {
    return "all " + FormatCount(std::ssize(a.arrivals)) +
           " messages of the frames arrived in the same order";
  }
  const auto [x, y] =
      std::mismatch(a.arrivals.begin(), a.arrivals.end(), b.arrivals.begin(), b.arrivals.end());
  const auto describe = [](const auto& at, const auto& end) {
    return at == end ? std::string("no further message") : at->channel + " of " + ToText(at->frame);
  };
  const Counts in_a = FramesBefore(a.arrivals), in_b = FramesBefore(b.arrivals);
  const auto other = std::count_if(in_a.begin(), in_a.end(), [&](const auto& entry) {
    const auto found = in_b.find(entry.first);
    return found == in_b.end() || found->second != entry.second;
  });
  return "the messages of the frames arrived in a different order from message " +
         std::to_string(x - a.arrivals.begin() + 1) + " on: " + describe(x, a.arrivals.end()) +
         " in " + a.name + ", " + describe(y, b.arrivals.end()) + " in " + b.name + "; " +
         FormatCount(other) + " of " + FormatCount(std::ssize(in_a)) +
         " frames arrived at another position among the frames";
}

}  // namespace

Result<RunRecord> ReadRunRecord(const std::string& path, const std::string& channel_prefix) {
  Result<LogReader> reader = LogReader::Open(path, channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  const Result<RecordedRun> run = ReadRun(*reader);
  if (!run) return tl::unexpected(run.error());
  RunRecord record{path, HistoryOfNewestMap(run->commits), {}};
  if (record.history.integrated.empty())
    return Fail(path + ": the log has no MAP_COMMIT of an integrated frame");
  reader = LogReader::Open(path, channel_prefix);
  if (!reader) return tl::unexpected(reader.error());
  Result<std::vector<Arrival>> arrivals = ReadArrivals(*reader);
  if (!arrivals) return tl::unexpected(arrivals.error());
  record.arrivals = std::move(*arrivals);
  return record;
}

std::string FirstDifference(const RunRecord& a, const RunRecord& b) {
  const auto& in_a = a.history.integrated;
  const auto& in_b = b.history.integrated;
  for (size_t i = 0; i < std::min(in_a.size(), in_b.size()); ++i) {
    if (KeyOf(in_a[i]) != KeyOf(in_b[i]))
      return Place(i, in_a[i]) + OtherFrame(a, b, in_a[i], in_b[i]);
    if (const std::string how = OtherResult(a, b, in_a[i], in_b[i]); !how.empty())
      return Place(i, in_a[i]) + how;
  }
  if (in_a.size() == in_b.size()) return "";
  const bool a_longer = in_a.size() > in_b.size();
  const RunRecord& longer = a_longer ? a : b;
  const RunRecord& shorter = a_longer ? b : a;
  const size_t next = shorter.history.integrated.size();
  const frame_commit_t& commit = longer.history.integrated[next];
  return Place(next, commit) + Absence(longer, shorter, KeyOf(commit));
}

std::vector<std::string> CompareFacts(const RunRecord& a, const RunRecord& b) {
  std::vector<std::string> facts;
  for (const RunRecord* run : {&a, &b}) {
    facts.push_back(run->name + ": map " + run->history.map_id + ", revision " +
                    std::to_string(run->history.integrated.back().revision) + ", " +
                    std::to_string(run->history.integrated.size()) + " frames integrated, " +
                    std::to_string(run->history.skipped.size()) + " skipped");
    for (const std::string& remark : run->history.remarks)
      facts.push_back(run->name + ": " + remark);
  }
  facts.push_back(CompareArrivals(a, b));
  return facts;
}

}  // namespace vismap
