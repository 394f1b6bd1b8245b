#pragma once

#include "base/result.h"
#include "config/process_options.h"

namespace vismap {

/// Chooses the backend. kAuto becomes kRecorded when `names_recording` (the command line names
/// detections or a sequence), else kDnn when the config names a model. Never returns kAuto. Fails
/// when the input of the chosen backend is missing, or when input of the other one is given.
Result<DetectorBackend> ChooseBackend(const DetectorOptions& config, bool names_recording);

}  // namespace vismap
