#include <cstdio>
#include <nlohmann/json.hpp>

#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/print_answer.h"
#include "map_tool/space_request.h"
#include "requests/navigation_answers.h"

// The subcommands `clearance` and `frontiers` of vismap-map.

namespace vismap {
namespace {

using Question = Result<Answer> (*)(const NavigationSpace&, const map_request_t&);

Result<map_request_t> NavigationRequest(const MapToolArguments& arguments, const char* verb) {
  Result<map_request_t> request = SpaceRequest(arguments, verb);
  if (request && !arguments.points.empty()) request->argument = "at=" + arguments.points;
  return request;
}

tl::expected<std::string, ExitFailure> AskFile(const MapToolArguments& arguments,
                                               const map_request_t& request, Question question) {
  const auto loaded = LoadSavedMap(arguments);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto voxels = SpaceOf(arguments, *loaded);
  if (!voxels) return tl::unexpected(voxels.error());
  NavigationSpace space;
  space.voxels = &*voxels;
  space.is_edited = !arguments.without.empty();
  space.map_id = loaded->metadata.map_id;
  space.revision = loaded->map.revision;
  space.utime = loaded->map.last_utime;
  space.octree = arguments.config.octree;
  space.robot_radius_m = arguments.config.octomap_exporter.robot_radius_m;
  const Result<Answer> answer = question(space, request);
  if (!answer) return ExitWith(ExitCode::kUsage, arguments.map + ": " + answer.error().message);
  return std::string(answer->payload.begin(), answer->payload.end());
}

/// The answer of the running exporter, or of a saved map.
tl::expected<std::string, ExitFailure> AskForJson(const MapToolArguments& arguments,
                                                  ProcessContext& context, const char* verb,
                                                  Question question) {
  const Result<map_request_t> request = NavigationRequest(arguments, verb);
  if (!request) return ExitWith(ExitCode::kUsage, request.error().message);
  if (arguments.map != kLive) return AskFile(arguments, *request, question);
  const auto reply = RequestFromServer(arguments, context, *request);
  if (!reply) return tl::unexpected(reply.error());
  return PayloadText(*reply);
}

std::string PointText(const nlohmann::json& p) {
  if (p.is_null()) return "none";
  char text[100];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", p.at(0).get<double>(),
                p.at(1).get<double>(), p.at(2).get<double>());
  return text;
}

void PrintClearance(const nlohmann::json& json) {
  for (const auto& point : json.at("points")) {
    std::printf("%s: %.3f m to %s, obstacle %.3f m, unknown %.3f m\n",
                PointText(point.at("at")).c_str(), point.at("distance_m").get<double>(),
                point.at("nearest").get<std::string>().c_str(),
                point.at("obstacle_m").get<double>(), point.at("unknown_m").get<double>());
  }
}

void PrintFrontiers(const nlohmann::json& json) {
  for (const auto& frontier : json.at("frontiers")) {
    std::printf("%6lld leaves around %s, seen from %s\n",
                static_cast<long long>(frontier.at("leaves").get<int64_t>()),
                PointText(frontier.at("center_W")).c_str(),
                PointText(frontier.at("viewpoint_W")).c_str());
  }
}

}  // namespace

Outcome RunClearance(const MapToolArguments& arguments, ProcessContext& context) {
  return PrintAnswer(arguments, AskForJson(arguments, context, "clearance", AnswerClearance),
                     PrintClearance);
}

Outcome RunFrontiers(const MapToolArguments& arguments, ProcessContext& context) {
  return PrintAnswer(arguments, AskForJson(arguments, context, "frontiers", AnswerFrontiers),
                     PrintFrontiers);
}

}  // namespace vismap
