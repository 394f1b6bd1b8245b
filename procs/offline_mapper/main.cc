#include "runtime/main.h"

#include <sys/resource.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/class_names.h"
#include "base/file.h"
#include "base/probe_folder.h"
#include "exports/outputs.h"
#include "exports/statistics.h"
#include "logs/recording.h"
#include "map/far_parts.h"
#include "plausibility/depth_losses.h"
#include "runtime/clock.h"
#include "runtime/progress.h"
#include "runtime/version.h"
#include "sequence_mapper/map_sequence.h"
#include "sequence_mapper/sequence_input.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

constexpr uint64_t kLeastSpace = 1 << 20;  // that must be free for the results [bytes]

struct Arguments {
  std::string dataset, format, detections, out;
  std::string model;  // of the network that looks at the frames; overrides the config
  DatasetOptions frames;
  CalibrationOptions calibration;
  ThreadOption threads;
  VismapConfig config;
};

void AddOptions(CommandLine& line, Arguments* arguments) {
  line.Option("--dataset", &arguments->dataset,
              "Folder of an RGB-D sequence with poses, log of LCM messages, synthetic:room or "
              "synthetic:office")
      .Required();
  line.Option("--format", &arguments->format,
              "Format of the folder; detected automatically if not given");
  line.Option("--detections", &arguments->detections,
              "COCO results file, folder of instance PNGs, log, or 'none'; if not given, those of "
              "the network in the config, else those of the sequence");
  line.Option("--detector-model", &arguments->model,
              "Run this network on the frames, see vismap-detector --model; further options are in "
              "the config")
      .Excludes("--detections");
  line.Option("--max-frames", &arguments->frames.max_frames, "Largest number of frames; 0 = all")
      .AtLeast(0);
  line.Option("--stride", &arguments->frames.stride, "Use every n-th frame only").Positive();
  arguments->calibration.AddTo(line);
  line.Option("--out", &arguments->out, "Folder for the results").Required();
  arguments->threads.AddTo(line);
}

nlohmann::ordered_json FiguresJson(const StageTimes& times) {
  nlohmann::ordered_json json;
  for (const std::string& stage : times.stages()) {
    const StageTimes::Figures figures = times.Of(stage);
    json[stage] = {{"median", figures.median}, {"p95", figures.p95}, {"max", figures.max}};
  }
  return json;
}

// What was mapped, and what became of the frames and detections of the sequence.
struct Run {
  const Dataset& dataset;
  const DetectionSource* detections;
  MapSession session;
  StageTimes times;
  SequenceCheck check;
  MappedSequence mapped;

  // All frames of the sequence that were not mapped.
  ReasonCounts LeftOut() const {
    ReasonCounts all = mapped.left_out;
    for (const SkippedFrame& skipped : dataset.skipped()) all.Add(skipped.reason);
    return all;
  }
  int64_t frames() const {
    return mapped.frames + mapped.left_out.total() + std::ssize(dataset.skipped());
  }
};

Result<void> WriteReport(const Arguments& arguments, const Run& run,
                         const std::vector<ObjectSummary>& objects,
                         const std::vector<std::string>& findings) {
  const MapSession& session = run.session;
  nlohmann::ordered_json report;
  report["dataset"] = run.dataset.name();
  report["format"] = run.dataset.format();
  report["frames"] = session.metadata().trajectory.size();
  report["frames_skipped"] = run.LeftOut().total();
  report["findings"] = findings;
  report["stages_ms"] = FiguresJson(run.times);
  report["map"] = nlohmann::ordered_json::parse(StatisticsJson(session.map(), session.metadata()));
  report["map"]["objects"] = std::count_if(
      objects.begin(), objects.end(),
      [](const ObjectSummary& object) { return !object.discovered() && !object.removed(); });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["peak_rss_bytes"] = static_cast<int64_t>(usage.ru_maxrss) * 1024;
  report["version"] = Version();
  return WriteFileAtomically(
      std::filesystem::path(arguments.out) / "report.json",
      report.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

// A sentence when detections belong to no frame of the whole sequence.
std::optional<std::string> UnusedDetections(const Arguments& arguments, const Run& run) {
  const bool whole = arguments.frames.stride == 1 && arguments.frames.max_frames == 0;
  const int64_t used = run.mapped.used_detections;
  if (run.detections == nullptr || !whole || run.detections->size() <= used) return std::nullopt;
  const int64_t all = run.detections->size(), unused = all - used;
  if (used > 0 && 10 * unused < all) return std::nullopt;
  std::string text = used == 0 ? "none of " + std::to_string(all) + " detections belongs to a frame"
                               : std::to_string(unused) + " of " + std::to_string(all) +
                                     " detections belong to no frame";
  if (const auto numbers = run.detections->frame_numbers()) {
    text += " (image ids " + std::to_string(numbers->first) + ".." +
            std::to_string(numbers->second) + ", frames " +
            std::to_string(run.dataset.Header(0).frame_number) + ".." +
            std::to_string(run.dataset.Header(run.dataset.size() - 1).frame_number) + ")";
  }
  return text;
}

// What is suspect about a sequence and its map, with the likely causes.
std::vector<std::string> FindingsOf(const Arguments& arguments, const Run& run, const Mesh& mesh) {
  std::vector<std::string> findings = run.check.Findings();
  if (mesh.triangles.empty()) findings.emplace_back("the map has no surface");
  const MappedSequence& mapped = run.mapped;
  for (std::string& lost : FindingsOf(mapped.depth_losses, arguments.config.surface))
    findings.push_back(std::move(lost));
  if (const ReasonCounts left_out = run.LeftOut(); left_out.total() > 0)
    findings.push_back(LeftOutText(left_out, run.frames()));
  if (mapped.blocks_left_out > 0) {
    findings.push_back("the map has reached its limit of " +
                       std::to_string(arguments.config.integration.max_map_mb) +
                       " MB (integration.max_map_mb): " + std::to_string(mapped.blocks_left_out) +
                       " new blocks were left out");
  }
  if (const auto far = FarParts(run.session.metadata().trajectory).Sentence())
    findings.push_back(*far);
  const std::string of_frames =
      " of " + std::to_string(mapped.frames) + " frames are mapped without ";
  if (mapped.without_color.total() > 0) {
    findings.push_back(std::to_string(mapped.without_color.total()) + of_frames +
                       "their colour: " + mapped.without_color.Text());
  }
  if (mapped.without_detections.total() > 0) {
    findings.push_back(std::to_string(mapped.without_detections.total()) + of_frames +
                       "their detections: " + mapped.without_detections.Text());
  }
  if (const auto unused = UnusedDetections(arguments, run)) findings.push_back(*unused);
  if (mapped.weak_detections > 0 && 10 * mapped.weak_detections >= 9 * mapped.used_detections) {
    findings.push_back(std::to_string(mapped.weak_detections) + " of " +
                       std::to_string(mapped.used_detections) +
                       " detections name no object: their score is below 0.09, or their mask is "
                       "empty");
  }
  return findings;
}

void Summarise(const Arguments& arguments, const MapSession& session, const MapProducts& products,
               const StageTimes& times) {
  size_t discovered = 0, removed = 0;
  for (const ObjectSummary& object : products.objects) {
    if (object.removed()) {
      ++removed;
      continue;
    }
    if (object.discovered()) {
      if (!object.is_structure()) ++discovered;
      continue;
    }
    std::printf("%4u  %-16s score %.2f  %.2f x %.2f x %.2f m\n", Raw(object.instance),
                ClassName(object.class_id).c_str(), object.score, object.box.size.x(),
                object.box.size.y(), object.box.size.z());
  }
  std::printf("%zu discovered segments without a class; %zu objects and segments were removed\n",
              discovered, removed);
  std::printf("up is %s: %s\n", DirectionText(products.up.up_W).c_str(),
              products.up.reason.c_str());
  std::printf(
      "%zu frames, median %.1f ms per frame (segmentation %.1f, association %.1f, integration "
      "%.1f)\n",
      session.metadata().trajectory.size(), times.Of("total").median,
      times.Of("segmentation").median, times.Of("association").median,
      times.Of("integration").median);
  std::printf("map hash %s; results in %s\n", HashMap(session.map()).c_str(),
              std::filesystem::absolute(arguments.out).c_str());
}

MapMetadata MetadataOf(const Arguments& arguments, const Dataset& dataset) {
  MapMetadata metadata;
  metadata.map_id = dataset.name();
  metadata.config = PrintConfig(arguments.config);
  metadata.created_by = std::string("vismap-offline-mapper ") + Version();
  return metadata;
}

Outcome MapFrames(const Arguments& arguments, DnnDetector* network, const ProcessContext& context,
                  Run* run) {
  Progress progress("mapping " + run->dataset.name(), static_cast<int64_t>(run->dataset.size()));
  const auto proceed = [&](size_t done) {
    progress.Show(static_cast<int64_t>(done));
    return !context.stop.requested();
  };
  Result<MappedSequence> mapped =
      MapSequence({run->dataset, run->detections, network, &run->check}, arguments.config, proceed,
                  &run->session, &run->times);
  if (!mapped) return ExitWith(ExitCode::kUnreadable, mapped.error().message);
  run->mapped = std::move(*mapped);
  if (run->mapped.frames == 0 && !context.stop.requested()) {
    return ExitWith(ExitCode::kUnreadable,
                    arguments.dataset + ": " + NoUsableFramesText(run->LeftOut(), run->frames()));
  }
  return {};
}

// Writes what there is, also when a part of it cannot be made or written.
Outcome WriteResults(const Arguments& arguments, Run* run) {
  const OutputOptions options = arguments.config;
  const MapSession& session = run->session;
  const double start = MonotonicSeconds();
  const MapProducts products = MakeProducts(session.map(), session.metadata(), options);
  run->times.Add("products", (MonotonicSeconds() - start) * 1e3);
  const auto written =
      WriteOutputs(session.map(), session.metadata(), products, options, arguments.out);
  std::vector<std::string> findings = FindingsOf(arguments, *run, products.mesh);
  const std::string problem = written ? *written : written.error().message;
  if (!problem.empty()) findings.push_back(problem);
  const auto reported = WriteReport(arguments, *run, products.objects, findings);
  Summarise(arguments, session, products, run->times);
  std::printf("%s\n", LeftOutText(run->LeftOut(), run->frames()).c_str());
  if (!written) findings.pop_back();
  for (const std::string& finding : findings) LogWarning(finding);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  if (!reported) return ExitWith(ExitCode::kFailed, reported.error().message);
  return {};
}

Outcome MapDataset(Arguments& arguments, ProcessContext& context) {
  const std::unique_ptr<ThreadLimit> limit = arguments.threads.Limit();
  const auto recording =
      OpenRecording(arguments.dataset, arguments.format, arguments.frames, arguments.config.adapter,
                    arguments.config.pipeline.channel_prefix);
  if (!recording) return ExitWith(ExitCode::kUnreadable, recording.error().message);
  const Dataset& dataset = *recording->dataset;
  for (const std::string& remark : recording->remarks) LogWarning(remark);
  for (const std::string& remark : dataset.remarks()) LogInfo(remark);
  const Result<SequenceDetector> detector = OpenSequenceDetector(
      arguments.detections, !arguments.model.empty(), arguments.config, dataset);
  if (!detector) return ExitWith(ExitCode::kUnreadable, detector.error().message);

  const NewFolders created(arguments.out);
  if (const auto usable = ProbeFolder(arguments.out, kLeastSpace); !usable)
    return ExitWith(ExitCode::kFailed, usable.error().message);
  const IntegrationOptions& integration = arguments.config.integration;
  Run run{dataset,
          detector->recorded.get(),
          MapSession(arguments.config, MetadataOf(arguments, dataset)),
          {},
          SequenceCheck({integration.min_range_m, integration.max_range_m}),
          {}};
  if (const Outcome mapped = MapFrames(arguments, detector->network.get(), context, &run);
      !mapped) {
    created.RemoveEmpty();
    return mapped;
  }
  if (context.stop.requested()) LogWarning("stopped early; writing what there is");
  return WriteResults(arguments, &run);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "offline-mapper";
  spec.summary =
      "Maps a recorded sequence in one process, without LCM, and writes all results to a folder.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) { AddOptions(line, &arguments); };
  UseConfig(&arguments.config, &spec, [&] {
    if (!arguments.model.empty()) arguments.config.detector.dnn.model = arguments.model;
    return arguments.calibration.SetIn(&arguments.frames);
  });
  spec.run = [&](ProcessContext& context) { return MapDataset(arguments, context); };
  return RunProcess(argc, argv, spec);
}
