#include "detector/choose_backend.h"

namespace vismap {

Result<DetectorBackend> ChooseBackend(const DetectorOptions& config, bool names_recording) {
  const bool has_model = !config.dnn.model.empty();
  DetectorBackend backend = config.backend;
  if (backend == DetectorBackend::kAuto) {
    if (!names_recording && !has_model)
      return Fail(
          "expected --detections or --dataset for recorded detections, or --model for a network");
    backend = names_recording ? DetectorBackend::kRecorded : DetectorBackend::kDnn;
  }
  if (backend == DetectorBackend::kRecorded && !names_recording)
    return Fail("the backend 'recorded' needs --detections or --dataset");
  if (backend == DetectorBackend::kDnn && names_recording)
    return Fail(
        "the backend 'dnn' runs on the frames on the bus and does not accept --detections or "
        "--dataset");
  if (backend == DetectorBackend::kDnn && !has_model)
    return Fail("the backend 'dnn' needs --model FILE or detector.model in the config");
  return backend;
}

}  // namespace vismap
