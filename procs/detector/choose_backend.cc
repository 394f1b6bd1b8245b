#include "detector/choose_backend.h"

namespace vismap {

Result<DetectorBackend> ChooseBackend(const DetectorOptions& config, bool names_recording) {
  const bool has_model = !config.dnn.model.empty();
  DetectorBackend backend = config.backend;
  if (backend == DetectorBackend::kAuto) {
    if (!names_recording && !has_model)
      return Fail("expected --detections or --dataset (recorded), or --model (dnn)");
    backend = names_recording ? DetectorBackend::kRecorded : DetectorBackend::kDnn;
  }
  if (backend == DetectorBackend::kRecorded && !names_recording)
    return Fail("backend recorded: expected --detections or --dataset");
  if (backend == DetectorBackend::kDnn && names_recording)
    return Fail(
        "backend dnn looks at the frames on the bus: it takes no --detections or --dataset");
  if (backend == DetectorBackend::kDnn && !has_model)
    return Fail("backend dnn: expected --model FILE, or detector.model in the config");
  return backend;
}

}  // namespace vismap
