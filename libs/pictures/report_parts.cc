#include "pictures/report_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/format.h"
#include "base/json_text.h"
#include "pictures/html.h"

namespace vismap {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kDeepest = 5;

std::string Cell(const Json& value, int depth);

std::string Table(const Json& json, int depth) {
  HtmlTable table({});
  for (const auto& [key, value] : json.items()) table.Add({Escaped(key), Cell(value, depth + 1)});
  return table.Html();
}

std::string Cell(const Json& value, int depth) {
  if (value.is_null()) return "&ndash;";
  if (value.is_string()) return Escaped(value.get<std::string>());
  if (value.is_number_float()) return Digits(value.get<double>(), 4);
  if (!value.is_structured()) return Escaped(value.dump());
  if (value.empty()) return "none";
  if (depth >= kDeepest) return Escaped(value.dump(-1, ' ', false, Json::error_handler_t::replace));
  return Table(value, depth);
}

std::optional<Json> Parsed(const std::string& text) {
  const auto json = ParseJson<Json>(text);
  if (!json || !json->is_object()) return std::nullopt;
  return *json;
}

std::string ReasonOfNoRun(const ReportInput& input) {
  return input.no_run.empty() ? "The report.json of the run is no JSON object." : input.no_run;
}

double NumberOf(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0;
}

std::string Bar(double share) {
  return "<span class=\"bar\" style=\"width:" + Digits(100 * std::clamp(share, 0.0, 1.0), 1) +
         "%\"></span>";
}

std::string ProcessHtml(const ReportProcess& process) {
  std::string html = "<details><summary>" + Escaped(process.source) + ": " +
                     Escaped(process.state) + "</summary>\n";
  HtmlTable facts({});
  facts.Add({"program", Escaped(process.process) + " " + Escaped(process.version)});
  facts.Add({"computer", Escaped(process.host)});
  facts.Add({"heard for", Escaped(FormatDuration(process.seconds))});
  if (!process.message.empty()) facts.Add({"last message", Escaped(process.message)});
  for (const std::string& finding : process.findings) facts.Add({"finding", Escaped(finding)});
  html += facts.Html();
  HtmlTable timings({"stage", "median [ms]", "longest [ms]"});
  for (const ReportProcess::Timing& timing : process.timings)
    timings.Add({Escaped(timing.name), Digits(timing.median_ms, 2), Digits(timing.max_ms, 2)});
  if (!timings.empty()) html += timings.Html();
  HtmlTable counters({"counter", "total", "per second"});
  for (const ReportProcess::Counter& counter : process.counters)
    counters.Add(
        {Escaped(counter.name), FormatCount(counter.value), Digits(counter.per_second, 2)});
  if (!counters.empty()) html += counters.Html();
  return html + "</details>\n";
}

}  // namespace

std::string Digits(double value, int digits) {
  if (!std::isfinite(value)) return "";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string Remark(const std::string& sentence) { return "<p>" + Escaped(sentence) + "</p>\n"; }

std::string JsonTables(const std::string& json) {
  const std::optional<Json> parsed = Parsed(json);
  if (!parsed) return Remark("This part is missing, since its text is no JSON object.");
  return Table(*parsed, 0);
}

std::string StageTimesHtml(const ReportInput& input) {
  const std::optional<Json> run = Parsed(input.run_json);
  if (!run) return Remark("The times of the stages are not known. " + ReasonOfNoRun(input));
  const auto stages = run->find("stages_ms");
  if (stages == run->end() || !stages->is_object() || stages->empty())
    return Remark("The report.json of the run has no times of stages.");
  double longest = 0;
  for (const auto& [name, stage] : stages->items())
    if (stage.is_object() && name != "products")
      longest = std::max(longest, NumberOf(stage, "median"));
  HtmlTable table({"stage", "median [ms]", "95 % [ms]", "longest [ms]", "median"});
  for (const auto& [name, stage] : stages->items()) {
    if (!stage.is_object()) continue;
    const double median = NumberOf(stage, "median");
    table.Add({Escaped(name), Digits(median, 2), Digits(NumberOf(stage, "p95"), 2),
               Digits(NumberOf(stage, "max"), 2),
               name == "products" || longest <= 0 ? "" : Bar(median / longest)});
  }
  return table.Html() +
         "<p>Per frame; \"products\" is the surface with its objects at the end.</p>\n";
}

std::string FindingsHtml(const ReportInput& input) {
  const std::optional<Json> run = Parsed(input.run_json);
  if (!run) return Remark("What was suspect in the run is not known. " + ReasonOfNoRun(input));
  const auto findings = run->find("findings");
  if (findings == run->end() || !findings->is_array())
    return Remark("The report.json of the run has no findings.");
  if (findings->empty()) return Remark("Nothing about this run is suspect.");
  std::string html = "<ul class=\"findings\">\n";
  for (const Json& finding : *findings)
    if (finding.is_string()) html += "<li>" + Escaped(finding.get<std::string>()) + "</li>\n";
  return html + "</ul>\n";
}

std::string ProcessesHtml(const ReportInput& input) {
  if (!input.no_processes.empty()) return Remark(input.no_processes);
  std::string html;
  HtmlTable channels({"channel", "messages", "size", "per second"});
  for (const ReportChannel& channel : input.channels) {
    channels.Add({Escaped(channel.name), FormatCount(channel.messages),
                  Escaped(FormatBytes(channel.bytes)), Digits(channel.per_second, 2)});
  }
  html += channels.empty() ? Remark("The log has no messages.") : channels.Html();
  if (input.processes.empty())
    html += Remark("The log has no STATUS messages, so nothing is known of the processes.");
  for (const ReportProcess& process : input.processes) html += ProcessHtml(process);
  return html;
}

}  // namespace vismap
