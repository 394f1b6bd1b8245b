#include "runtime/main.h"

#include <sys/resource.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/class_names.h"
#include "base/file.h"
#include "exports/outputs.h"
#include "exports/statistics.h"
#include "logs/recording.h"
#include "offline_mapper/offline_mapper.h"
#include "plausibility/camera_check.h"
#include "runtime/clock.h"
#include "runtime/progress.h"
#include "runtime/version.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

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

// The detections to use: those asked for, else those inside the sequence; none when told so or when
// there are none.
Result<std::unique_ptr<DetectionSource>> FindDetections(const Arguments& arguments,
                                                        const Dataset& dataset) {
  if (arguments.detections == "none") return nullptr;
  if (!arguments.detections.empty()) return OpenRecordedDetections(arguments.detections);
  if (const std::optional<std::string> inside = dataset.default_detections_path())
    return OpenRecordedDetections(*inside);
  LogWarning(dataset.name() +
             " has no detections, so only geometry is mapped and no object gets a class");
  return nullptr;
}

// The network to use; none when detections are named, or no network is.
Result<std::unique_ptr<DnnDetector>> FindNetwork(const Arguments& arguments) {
  const DetectorOptions& config = arguments.config.detector;
  const bool recorded =
      !arguments.detections.empty() || config.backend == DetectorBackend::kRecorded;
  if (config.dnn.model.empty() || (recorded && arguments.model.empty())) return nullptr;
  return DnnDetector::Load(config.dnn);
}

nlohmann::ordered_json FiguresJson(const StageTimes& times) {
  nlohmann::ordered_json json;
  for (const std::string& stage : times.stages()) {
    const StageTimes::Figures figures = times.Of(stage);
    json[stage] = {{"median", figures.median}, {"p95", figures.p95}, {"max", figures.max}};
  }
  return json;
}

Result<void> WriteReport(const Arguments& arguments, const Dataset& dataset,
                         const MapSession& session, const std::vector<ObjectSummary>& objects,
                         const StageTimes& times, const std::vector<std::string>& findings) {
  nlohmann::ordered_json report;
  report["dataset"] = dataset.name();
  report["format"] = dataset.format();
  report["frames"] = session.metadata().trajectory.size();
  report["frames_skipped"] = dataset.skipped().size();
  report["findings"] = findings;
  report["stages_ms"] = FiguresJson(times);
  report["map"] = nlohmann::ordered_json::parse(StatisticsJson(session.map(), session.metadata()));
  report["map"]["objects"] = std::count_if(
      objects.begin(), objects.end(),
      [](const ObjectSummary& object) { return !object.discovered() && !object.removed(); });
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["peak_rss_bytes"] = static_cast<int64_t>(usage.ru_maxrss) * 1024;
  report["version"] = Version();
  return WriteFileAtomically(std::filesystem::path(arguments.out) / "report.json",
                             report.dump(1) + "\n");
}

// "2 of 10 frames were left out: 2 x pose is not rigid".
std::string LeftOutText(const Dataset& dataset) {
  std::map<std::string, size_t> reasons;
  for (const SkippedFrame& skipped : dataset.skipped()) ++reasons[skipped.reason];
  std::string text = std::to_string(dataset.skipped().size()) + " of " +
                     std::to_string(dataset.size() + dataset.skipped().size()) +
                     " frames were left out";
  constexpr size_t kMaxReasons = 5;
  size_t shown = 0;
  for (const auto& [reason, frames] : reasons) {
    if (shown++ == kMaxReasons) return text + "; and for other reasons";
    text += (shown == 1 ? ": " : "; ") + std::to_string(frames) + " x " + reason;
  }
  return text;
}

// What is suspect about a sequence and its map, with the likely causes.
std::vector<std::string> FindingsOf(const Dataset& dataset, const SequenceCheck& check,
                                    const Mesh& mesh) {
  std::vector<std::string> findings = UnusualCamera(dataset.Header(0).camera);
  if (mesh.triangles.empty()) findings.emplace_back("the map has no surface");
  for (const std::string& finding : check.Findings()) findings.push_back(finding);
  return findings;
}

// A sentence when detections belong to no frame of the whole sequence.
std::optional<std::string> UnusedDetections(const Arguments& arguments, const Dataset& dataset,
                                            const DetectionSource* detections, int64_t used) {
  const bool whole = arguments.frames.stride == 1 && arguments.frames.max_frames == 0;
  if (detections == nullptr || !whole || detections->size() <= used) return std::nullopt;
  const int64_t unused = detections->size() - used;
  if (used > 0 && 10 * unused < detections->size()) return std::nullopt;
  std::string text =
      used == 0 ? "none of " + std::to_string(detections->size()) + " detections belongs to a frame"
                : std::to_string(unused) + " of " + std::to_string(detections->size()) +
                      " detections belong to no frame";
  if (const auto numbers = detections->frame_numbers()) {
    text += " (image ids " + std::to_string(numbers->first) + ".." +
            std::to_string(numbers->second) + ", frames " +
            std::to_string(dataset.Header(0).frame_number) + ".." +
            std::to_string(dataset.Header(dataset.size() - 1).frame_number) + ")";
  }
  return text;
}

void Summarise(const Arguments& arguments, const MapSession& session,
               const std::vector<ObjectSummary>& objects, const StageTimes& times) {
  size_t discovered = 0, removed = 0;
  for (const ObjectSummary& object : objects) {
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
  std::printf(
      "%zu frames, median %.1f ms per frame (segmentation %.1f, association %.1f, integration "
      "%.1f)\n",
      session.metadata().trajectory.size(), times.Of("total").median,
      times.Of("segmentation").median, times.Of("association").median,
      times.Of("integration").median);
  std::printf("map hash %s; results in %s\n", HashMap(session.map()).c_str(),
              std::filesystem::absolute(arguments.out).c_str());
}

Outcome Run(Arguments& arguments, ProcessContext& context) {
  const std::unique_ptr<ThreadLimit> limit = arguments.threads.Limit();
  const auto recording = OpenRecording(arguments.dataset, arguments.format, arguments.frames);
  if (!recording) return ExitWith(ExitCode::kUnreadable, recording.error().message);
  for (const std::string& remark : recording->remarks) LogWarning(remark);
  const std::unique_ptr<Dataset>& dataset = recording->dataset;
  for (const std::string& remark : dataset->remarks()) LogInfo(remark);
  if (dataset->size() == 0)
    return ExitWith(ExitCode::kUnreadable, arguments.dataset + ": no usable frames");
  for (const SkippedFrame& skipped : dataset->skipped()) {
    LogWarningRateLimited("skipped", "frame " + std::to_string(skipped.frame_number) +
                                         " left out: " + skipped.reason);
  }
  const auto network = FindNetwork(arguments);
  if (!network) return ExitWith(ExitCode::kUnreadable, network.error().message);
  const auto detections = *network ? Result<std::unique_ptr<DetectionSource>>(nullptr)
                                   : FindDetections(arguments, *dataset);
  if (!detections) return ExitWith(ExitCode::kUnreadable, detections.error().message);

  MapMetadata metadata;
  metadata.map_id = dataset->name();
  metadata.config = PrintConfig(arguments.config);
  metadata.created_by = std::string("vismap-offline-mapper ") + Version();
  MapSession session(arguments.config, std::move(metadata));
  StageTimes times;
  SequenceCheck check(
      {arguments.config.integration.min_range_m, arguments.config.integration.max_range_m},
      dataset->depth_unit_m());
  int64_t used_detections = 0;
  {
    Progress progress("mapping " + dataset->name(), static_cast<int64_t>(dataset->size()));
    const auto proceed = [&](size_t done) {
      progress.Show(static_cast<int64_t>(done));
      return !context.stop.requested();
    };
    const auto mapped = MapSequence({*dataset, detections->get(), network->get(), &check},
                                    arguments.config, proceed, &session, &times);
    if (!mapped) return ExitWith(ExitCode::kUnreadable, mapped.error().message);
    used_detections = *mapped;
  }
  if (context.stop.requested()) LogWarning("stopped early; writing what there is");

  const OutputOptions options = arguments.config;
  const double start = MonotonicSeconds();
  const MapProducts products = MakeProducts(session.map(), session.metadata(), options);
  times.Add("products", (MonotonicSeconds() - start) * 1e3);
  const auto written =
      WriteOutputs(session.map(), session.metadata(), products, options, arguments.out);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  std::vector<std::string> findings = FindingsOf(*dataset, check, products.mesh);
  if (const auto unused = UnusedDetections(arguments, *dataset, detections->get(), used_detections))
    findings.push_back(*unused);
  const auto reported =
      WriteReport(arguments, *dataset, session, products.objects, times, findings);
  if (!reported) return ExitWith(ExitCode::kFailed, reported.error().message);
  Summarise(arguments, session, products.objects, times);
  std::printf("%s\n", LeftOutText(*dataset).c_str());
  for (const std::string& finding : findings) LogWarning(finding);
  return {};
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
  spec.run = [&](ProcessContext& context) { return Run(arguments, context); };
  return RunProcess(argc, argv, spec);
}
