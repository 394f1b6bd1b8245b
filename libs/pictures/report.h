#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "exports/outputs.h"

namespace vismap {

/// What one process said of itself in a log.
struct ReportProcess {
  struct Timing {
    std::string name;
    double median_ms = 0, max_ms = 0;  ///< median of the medians, and the longest
  };
  struct Counter {
    std::string name;
    int64_t value = 0;
    double per_second = 0;
  };
  std::string source, process, host, version, state, message;
  double seconds = 0;  ///< from the first to the last status
  std::vector<Counter> counters;
  std::vector<Timing> timings;
  std::vector<std::string> findings;
};

/// The messages of a channel in a log.
struct ReportChannel {
  std::string name;
  int64_t messages = 0, bytes = 0;
  double per_second = 0;
};

/// What a report shows besides the map. A sentence says why a part is missing. All texts may come
/// from outside; the report escapes them.
struct ReportInput {
  std::string source;        ///< what was mapped, or the file of the map
  std::string run_json;      ///< report.json of vismap-offline-mapper; "" = there is none
  std::string no_run;        ///< why
  std::string scores_json;   ///< of vismap-evaluate; "" = there are none
  std::string no_scores;     ///< why
  std::string script;        ///< report.js of the viewer's page; "" = it was not built
  std::string no_script;     ///< why
  std::string no_processes;  ///< why there are neither processes nor channels
  std::vector<ReportProcess> processes;
  std::vector<ReportChannel> channels;
  std::string version;  ///< of the program that makes the report
};

/// One HTML page of a map and its run that needs no other file and no network. `on_part` is called
/// with the name of each part before it is made; when it answers false, no further part is made,
/// and the result is empty.
std::string ReportHtml(const LoadedMap& loaded, const OutputOptions& options,
                       const ReportInput& input,
                       const std::function<bool(const std::string&)>& on_part);

}  // namespace vismap
