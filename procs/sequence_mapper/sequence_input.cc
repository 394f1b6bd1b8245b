#include "sequence_mapper/sequence_input.h"

#include <optional>

#include "logs/recording.h"
#include "runtime/log.h"

namespace vismap {
namespace {

// The detections to use: those asked for, else those inside the sequence; none when told so or when
// there are none.
Result<std::unique_ptr<DetectionSource>> FindDetections(const std::string& detections,
                                                        const std::string& channel_prefix,
                                                        const Dataset& dataset) {
  if (detections == "none") return nullptr;
  if (!detections.empty()) return OpenRecordedDetections(detections, channel_prefix);
  if (const std::optional<std::string> inside = dataset.default_detections_path())
    return OpenRecordedDetections(*inside, channel_prefix);
  LogWarning(dataset.name() +
             " has no detections, so only geometry is mapped and no object gets a class");
  return nullptr;
}

}  // namespace

Result<SequenceDetector> OpenSequenceDetector(const std::string& detections, bool network_first,
                                              const VismapConfig& config, const Dataset& dataset) {
  SequenceDetector found;
  const bool recorded =
      !detections.empty() || config.detector.backend == DetectorBackend::kRecorded;
  if (!config.detector.dnn.model.empty() && (!recorded || network_first)) {
    Result<std::unique_ptr<DnnDetector>> network = DnnDetector::Load(config.detector.dnn);
    if (!network) return tl::unexpected(network.error());
    found.network = std::move(*network);
    return found;
  }
  auto source = FindDetections(detections, config.pipeline.channel_prefix, dataset);
  if (!source) return tl::unexpected(source.error());
  found.recorded = std::move(*source);
  return found;
}

}  // namespace vismap
