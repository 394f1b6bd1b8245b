#include "map_tool/commands.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "datasets/class_names.h"
#include "map_tool/compare_runs.h"
#include "map_tool/map_diff.h"
#include "map_tool/server_client.h"
#include "render/overview.h"
#include "render/png.h"
#include "session/statistics.h"

namespace vismap {
namespace {

constexpr const char* kLive = "live";

// The answer of a running server, or why the program ends.
tl::expected<map_reply_t, ExitFailure> AskServer(const MapToolArguments& arguments,
                                                 ProcessContext& context, const std::string& verb,
                                                 const std::string& path = "",
                                                 const std::string& argument = "") {
  // The process number keeps two callers apart, so that each gets its own answer.
  const auto bus = OpenBus(context.options, context.options.name + "-" + std::to_string(getpid()),
                           &context.stop);
  if (!bus) return ExitWith(ExitCode::kFailed, bus.error().message);
  map_request_t request{};
  request.verb = verb;
  request.path = path;
  request.argument = argument;
  Result<map_reply_t> reply = Ask(**bus, request, arguments.timeout);
  if (!reply) return ExitWith(ExitCode::kFailed, reply.error().message);
  return std::move(*reply);
}

std::string PayloadText(const map_reply_t& reply) {
  return {reply.payload.begin(), reply.payload.end()};
}

// Statistics of a map file or of the live map, as JSON text.
tl::expected<std::string, ExitFailure> Statistics(const MapToolArguments& arguments,
                                                  ProcessContext& context) {
  if (arguments.map == kLive) {
    const auto reply = AskServer(arguments, context, "statistics");
    if (!reply) return tl::unexpected(reply.error());
    return PayloadText(*reply);
  }
  const Result<LoadedMap> loaded = LoadMap(arguments.map);
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  return StatisticsJson(loaded->map, loaded->metadata);
}

void PrintObjects(const nlohmann::json& list) {
  std::printf("%8s  %-16s %5s  %7s  %-22s %-24s %s\n", "instance", "class", "score", "points",
              "size [m]", "center [m]", "frames");
  for (const auto& object : list.at("objects")) {
    const auto& size = object.at("size");
    const auto& center = object.at("center");
    std::printf(
        "%8d  %-16s %5.2f  %7d  %5.2f x %5.2f x %5.2f  (%6.2f, %6.2f, %6.2f)  %d\n",
        object.at("instance").get<int>(), object.at("class_name").get<std::string>().c_str(),
        object.at("score").get<double>(), object.at("points").get<int>(), size[0].get<double>(),
        size[1].get<double>(), size[2].get<double>(), center[0].get<double>(),
        center[1].get<double>(), center[2].get<double>(), object.at("frames").get<int>());
  }
  int things = 0, structure = 0;
  for (const auto& segment : list.at("discovered"))
    ++(segment.value("structure", false) ? structure : things);
  std::printf("%d discovered segments without a class, %d of structure (--json lists them)\n",
              things, structure);
}

Coloring ColoringOf(const std::string& name) {
  if (name == "class") return Coloring::kClass;
  if (name == "segment") return Coloring::kSegment;
  if (name == "rgb") return Coloring::kRgb;
  return Coloring::kInstance;
}

Image<Rgb8> Render(const MapToolArguments& arguments, const LoadedMap& loaded) {
  const OutputOptions options = OutputOptionsOf(arguments.config);
  const MapProducts products = MakeProducts(loaded.map, loaded.metadata, options);
  const Eigen::Vector3d up_W = ObjectOptionsFor(loaded.metadata, options).up_W;
  const Coloring coloring = ColoringOf(arguments.coloring);
  OverviewOptions overview;
  overview.coloring = coloring;
  overview.up_W = up_W;
  if (arguments.view == "overview") {
    return RenderMapOverview(products.mesh, products.objects, ClassName, loaded.metadata.map_id,
                             overview);
  }
  const SceneBox scene = FrameScene(products.mesh, up_W);
  const View view = arguments.view == "top" ? TopDownView(scene, overview.width, overview.height)
                                            : BestPerspectiveView(products.mesh, scene,
                                                                  overview.width, overview.height);
  return RenderMesh(products.mesh, view, coloring);
}

Outcome TellServer(const MapToolArguments& arguments, ProcessContext& context,
                   const std::string& verb, const std::string& path) {
  const auto reply = AskServer(arguments, context, verb, path);
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
  const auto json = nlohmann::ordered_json::parse(*statistics);  // items() only refers to it
  for (const auto& [key, value] : json.items()) {
    std::printf("%-20s %s\n", key.c_str(),
                value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
  }
  return {};
}

Outcome RunHash(const MapToolArguments& arguments, ProcessContext& context) {
  const auto statistics = Statistics(arguments, context);
  if (!statistics) return tl::unexpected(statistics.error());
  std::printf("%s\n", nlohmann::json::parse(*statistics).at("hash").get<std::string>().c_str());
  return {};
}

Outcome RunObjects(const MapToolArguments& arguments, ProcessContext& context) {
  std::string text;
  if (arguments.map == kLive) {
    const auto reply = AskServer(arguments, context, "objects");
    if (!reply) return tl::unexpected(reply.error());
    text = PayloadText(*reply);
  } else {
    const Result<LoadedMap> loaded = LoadMap(arguments.map);
    if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
    text = ObjectsText(loaded->metadata, MakeProducts(loaded->map, loaded->metadata,
                                                      OutputOptionsOf(arguments.config)));
  }
  if (arguments.json) {
    std::printf("%s\n", text.c_str());
  } else {
    PrintObjects(nlohmann::json::parse(text));
  }
  return {};
}

Outcome RunExport(const MapToolArguments& arguments, ProcessContext&) {
  const Result<LoadedMap> loaded = LoadMap(arguments.map);
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  const OutputOptions options = OutputOptionsOf(arguments.config);
  const MapProducts products = MakeProducts(loaded->map, loaded->metadata, options);
  const auto written =
      WriteOutputs(loaded->map, loaded->metadata, products, options, arguments.out);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  PrintObjects(nlohmann::json::parse(ObjectsText(loaded->metadata, products)));
  std::printf("map hash %s\nresults in %s\n", loaded->map_hash.c_str(),
              std::filesystem::absolute(arguments.out).c_str());
  return {};
}

Outcome RunRender(const MapToolArguments& arguments, ProcessContext&) {
  const Result<LoadedMap> loaded = LoadMap(arguments.map);
  if (!loaded) return ExitWith(ExitCode::kUnreadable, loaded.error().message);
  const Result<void> written = WritePng(arguments.out, Render(arguments, *loaded));
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("picture in %s\n", std::filesystem::absolute(arguments.out).c_str());
  return {};
}

Outcome RunDiff(const MapToolArguments& arguments, ProcessContext&) {
  const Result<LoadedMap> a = LoadMap(arguments.map), b = LoadMap(arguments.other_map);
  if (!a) return ExitWith(ExitCode::kUnreadable, a.error().message);
  if (!b) return ExitWith(ExitCode::kUnreadable, b.error().message);
  const std::vector<std::string> differences = DiffMaps(*a, *b);
  for (const std::string& sentence : differences) std::printf("%s\n", sentence.c_str());
  if (!differences.empty()) return ExitWith(ExitCode::kFailed, "the maps differ");
  std::printf("equal: map hash %s\n", a->map_hash.c_str());
  return {};
}

Outcome RunCompareRuns(const MapToolArguments& arguments, ProcessContext&) {
  const Result<RunRecord> a = ReadRunRecord(arguments.map), b = ReadRunRecord(arguments.other_map);
  if (!a) return ExitWith(ExitCode::kUnreadable, a.error().message);
  if (!b) return ExitWith(ExitCode::kUnreadable, b.error().message);
  for (const std::string& fact : CompareFacts(*a, *b)) std::printf("%s\n", fact.c_str());
  const std::string difference = FirstDifference(*a, *b);
  std::printf("%s\n", difference.empty() ? "equal: every frame had the same inputs and did the same"
                                         : difference.c_str());
  if (difference.empty()) return {};
  return ExitWith(ExitCode::kFailed, "the runs differ");
}

Outcome RunSave(const MapToolArguments& arguments, ProcessContext& context) {
  const std::string path =
      arguments.out.empty() ? "" : std::filesystem::absolute(arguments.out).string();
  return TellServer(arguments, context, "save", path);
}

Outcome RunLoad(const MapToolArguments& arguments, ProcessContext& context) {
  return TellServer(arguments, context, "load", std::filesystem::absolute(arguments.map).string());
}

Outcome RunDigests(const MapToolArguments& arguments, ProcessContext& context) {
  const auto statistics = AskServer(arguments, context, "statistics");
  if (!statistics) return tl::unexpected(statistics.error());
  const auto mesh = AskServer(arguments, context, "mesh", "", "digest");
  if (!mesh) return tl::unexpected(mesh.error());
  const auto exporter = AskServer(arguments, context, "octomap-digest");
  if (!exporter) return tl::unexpected(exporter.error());
  const auto facts = nlohmann::json::parse(PayloadText(*statistics));
  const nlohmann::ordered_json digests = {{"map_id", statistics->map_id},
                                          {"map_revision", statistics->revision},
                                          {"occupancy_server", facts.at("occupancy_digest")},
                                          {"exporter_map_id", exporter->map_id},
                                          {"exporter_revision", exporter->revision},
                                          {"occupancy_exporter", exporter->message},
                                          {"mesh_server", mesh->message}};
  for (const auto& [key, value] : digests.items()) {
    if (!arguments.json)
      std::printf("%-20s %s\n", key.c_str(),
                  value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
  }
  if (arguments.json) std::printf("%s\n", digests.dump().c_str());
  return {};
}

Outcome RunReset(const MapToolArguments& arguments, ProcessContext& context) {
  return TellServer(arguments, context, "reset", "");
}

}  // namespace vismap
