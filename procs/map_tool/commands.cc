#include "map_tool/commands.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "base/file.h"
#include "base/format.h"
#include "base/json_text.h"
#include "base/printable.h"
#include "exports/statistics.h"
#include "map_tool/compare_runs.h"
#include "map_tool/live_map.h"
#include "map_tool/map_diff.h"
#include "mapfile/map_folder.h"

namespace vismap {
namespace {

// Statistics of a saved map or of the live map, as JSON text.
tl::expected<std::string, ExitFailure> Statistics(const MapToolArguments& arguments,
                                                  ProcessContext& context) {
  if (arguments.map == kLive) {
    const auto reply = RequestFromServer(arguments, context, "statistics");
    if (!reply) return tl::unexpected(reply.error());
    return PayloadText(*reply);
  }
  const Result<LoadedMap> loaded =
      LoadMap(arguments.map, MaxMapBytes(arguments.config.integration));
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  return StatisticsJson(loaded->map, loaded->metadata);
}

// A fact as people read it: sizes with a unit, counts with groups of digits.
std::string FactText(const std::string& key, const nlohmann::ordered_json& value) {
  if (value.is_string()) return PrintableText(value.get<std::string>());
  if (!value.is_number_integer() || key.ends_with("utime")) return value.dump();
  const bool is_size = key == "bytes" || key.starts_with("bytes_");
  return is_size ? FormatBytes(value.get<int64_t>()) : FormatCount(value.get<int64_t>());
}

void PrintFacts(const nlohmann::ordered_json& facts) {
  for (const auto& [key, value] : facts.items())
    std::printf("%-20s %s\n", key.c_str(), FactText(key, value).c_str());
}

// A server takes names of maps; for a path, the error says what to do instead.
Outcome CheckName(const std::string& verb, const std::string& name) {
  const Result<void> checked = CheckMapName(name);
  if (checked) return {};
  const std::filesystem::path path = std::filesystem::absolute(name).lexically_normal();
  const std::string folder = path.parent_path().string(), stem = path.stem().string();
  std::string advice;
  if (name.find('/') != std::string::npos && CheckMapName(stem)) {
    advice =
        "; the server keeps its maps in one folder, which --map-folder or map_server.map_folder "
        "of its config sets: start it with --map-folder " +
        folder + ", then: vismap-map " + verb + " " + stem;
  }
  return ExitWith(ExitCode::kUsage, checked.error().message + advice);
}

Outcome SendCommand(const MapToolArguments& arguments, ProcessContext& context,
                    const std::string& verb, const std::string& path) {
  const auto reply = RequestFromServer(arguments, context, verb, path);
  if (!reply) return tl::unexpected(reply.error());
  std::printf("%s\n", reply->message.c_str());
  return {};
}

}  // namespace

Outcome RunInfo(const MapToolArguments& arguments, ProcessContext& context) {
  const auto statistics = Statistics(arguments, context);
  if (!statistics) return tl::unexpected(statistics.error());
  if (arguments.json) {
    std::printf("%s\n", statistics->c_str());
    return {};
  }
  const auto json = ParseJson<nlohmann::ordered_json>(*statistics).value();
  for (const auto& [key, value] : json.items()) {
    std::printf(
        "%-20s %s\n", key.c_str(),
        (value.is_string() ? PrintableText(value.get<std::string>()) : value.dump()).c_str());
  }
  return {};
}

Outcome RunHash(const MapToolArguments& arguments, ProcessContext& context) {
  const auto statistics = Statistics(arguments, context);
  if (!statistics) return tl::unexpected(statistics.error());
  std::printf("%s\n",
              PrintableText(ParseJson(*statistics).value().at("hash").get<std::string>()).c_str());
  return {};
}

Outcome RunDiff(const MapToolArguments& arguments, ProcessContext&) {
  const size_t most = MaxMapBytes(arguments.config.integration);
  const Result<LoadedMap> a = LoadMap(arguments.map, most), b = LoadMap(arguments.other_map, most);
  if (!a) return ExitWith(ExitCode::kUnreadable, a.error().message);
  if (!b) return ExitWith(ExitCode::kUnreadable, b.error().message);
  const std::vector<std::string> differences = DiffMaps(*a, *b);
  for (const std::string& sentence : differences) std::printf("%s\n", sentence.c_str());
  if (!differences.empty()) return ExitWith(ExitCode::kFailed, "the maps differ");
  std::printf("the maps are equal; their map hash is %s\n", a->map_hash.c_str());
  return {};
}

Outcome RunCompareRuns(const MapToolArguments& arguments, ProcessContext& context) {
  const std::string& prefix = context.options.channel_prefix;
  const Result<RunRecord> a = ReadRunRecord(arguments.map, prefix),
                          b = ReadRunRecord(arguments.other_map, prefix);
  if (!a) return ExitWith(ExitCode::kUnreadable, a.error().message);
  if (!b) return ExitWith(ExitCode::kUnreadable, b.error().message);
  for (const std::string& fact : CompareFacts(*a, *b))
    std::printf("%s\n", PrintableText(fact).c_str());
  const std::string difference = PrintableText(FirstDifference(*a, *b));
  std::printf("%s\n", difference.empty()
                          ? "the runs are equal: every frame had the same input and the same effect"
                          : difference.c_str());
  if (difference.empty()) return {};
  return ExitWith(ExitCode::kFailed, "the runs differ");
}

// Gets the map from the server and writes it to a file of this computer, as this user.
Outcome FetchMap(const MapToolArguments& arguments, ProcessContext& context) {
  const auto map = RequestFromServer(arguments, context, "map");
  if (!map) return tl::unexpected(map.error());
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(map->payload.data()),
                                       map->payload.size());
  if (const Result<void> written = WriteFileAtomically(arguments.map, bytes); !written)
    return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("saved %zu bytes to %s, map hash %s\n", bytes.size(),
              std::filesystem::absolute(arguments.map).c_str(),
              PrintableText(map->message).c_str());
  return {};
}

Outcome RunSave(const MapToolArguments& arguments, ProcessContext& context) {
  if (arguments.map.empty()) return SendCommand(arguments, context, "save", "");
  if (arguments.map.find('/') != std::string::npos) return FetchMap(arguments, context);
  if (const Outcome checked = CheckName("save", arguments.map); !checked) return checked;
  return SendCommand(arguments, context, "save", arguments.map);
}

Outcome RunLoad(const MapToolArguments& arguments, ProcessContext& context) {
  if (const Outcome checked = CheckName("load", arguments.map); !checked) return checked;
  return SendCommand(arguments, context, "load", arguments.map);
}

Outcome RunDigests(const MapToolArguments& arguments, ProcessContext& context) {
  const auto statistics = RequestFromServer(arguments, context, "statistics");
  if (!statistics) return tl::unexpected(statistics.error());
  const auto mesh = RequestFromServer(arguments, context, "mesh", "", "digest");
  if (!mesh) return tl::unexpected(mesh.error());
  const auto exporter = RequestFromServer(arguments, context, "octomap-digest");
  if (!exporter) return tl::unexpected(exporter.error());
  const auto facts = ParseJson(PayloadText(*statistics)).value();
  const nlohmann::ordered_json digests = {{"map_id", statistics->map_id},
                                          {"map_revision", statistics->revision},
                                          {"occupancy_server", facts.at("occupancy_digest")},
                                          {"exporter_map_id", exporter->map_id},
                                          {"exporter_revision", exporter->revision},
                                          {"occupancy_exporter", exporter->message},
                                          {"mesh_server", mesh->message}};
  if (arguments.json) {
    std::printf("%s\n",
                digests.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    PrintFacts(digests);
  }
  return {};
}

Outcome RunReset(const MapToolArguments& arguments, ProcessContext& context) {
  return SendCommand(arguments, context, "reset", "");
}

}  // namespace vismap
