#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/class_names.h"
#include "exports/explain_cell.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/print_answer.h"
#include "requests/request_argument.h"

// The subcommand `cell` of vismap-map.

namespace vismap {
namespace {

tl::expected<std::string, ExitFailure> ExplainOf(const MapToolArguments& arguments,
                                                 ProcessContext& context) {
  const Result<std::vector<double>> at = ReadNumbersOf("--at", arguments.points, 3);
  if (!at) return ExitWith(ExitCode::kUsage, at.error().message);
  if (arguments.map == kLive) {
    const auto reply = RequestFromServer(arguments, context, "cell", "", "at=" + arguments.points);
    if (!reply) return tl::unexpected(reply.error());
    return PayloadText(*reply);
  }
  const auto loaded = LoadMapOrLive(arguments, context);
  if (!loaded) return tl::unexpected(loaded.error());
  const Result<std::string> json =
      ExplainCell(loaded->map, loaded->metadata, arguments.config.free_space,
                  {(*at)[0], (*at)[1], (*at)[2]}, ClassName);
  if (!json) return ExitWith(ExitCode::kUsage, "--at: " + json.error().message);
  return *json;
}

void PrintCell(const nlohmann::json& json) {
  const auto& voxel = json.at("voxel");
  std::printf("voxel (%d, %d, %d): %s, since %s\n", voxel.at(0).get<int>(), voxel.at(1).get<int>(),
              voxel.at(2).get<int>(), json.at("state").get<std::string>().c_str(),
              json.at("why").get<std::string>().c_str());
  std::printf("block: %s, observations: %d", json.at("block").get<std::string>().c_str(),
              json.at("observations").get<int>());
  if (json.at("distance_m").is_number())
    std::printf(", signed distance: %.4f m, weight: %.2f", json.at("distance_m").get<double>(),
                json.at("weight").get<double>());
  std::printf("\n");
  for (const auto& label : json.at("labels")) {
    std::printf("label %u (now %u): %d votes, instance %u, %s\n", label.at("label").get<uint32_t>(),
                label.at("shown_as").get<uint32_t>(), label.at("votes").get<int>(),
                label.at("instance").get<uint32_t>(),
                label.at("class_name").get<std::string>().c_str());
  }
  const auto& shown = json.at("shown");
  std::printf("shown: segment %u, instance %u, %s\n", shown.at("segment").get<uint32_t>(),
              shown.at("instance").get<uint32_t>(),
              shown.at("class_name").get<std::string>().c_str());
}

}  // namespace

Outcome RunCell(const MapToolArguments& arguments, ProcessContext& context) {
  return PrintAnswer(arguments, ExplainOf(arguments, context), PrintCell);
}

}  // namespace vismap
