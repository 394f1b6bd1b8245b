#pragma once

#include "base/result.h"
#include "config/process_options.h"

namespace vismap {

/// Which backend works: what the config says; kAuto is recorded when `names_recording` (the command
/// line names detections or a sequence), else the network when there is a model. Never returns
/// kAuto. Fails, with what to say, when the chosen one lacks its input or the other's is given,
/// too.
Result<DetectorBackend> ChooseBackend(const DetectorOptions& config, bool names_recording);

}  // namespace vismap
