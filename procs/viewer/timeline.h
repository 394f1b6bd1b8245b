#pragma once

#include <string>

#include "viewer/log_recording.h"

namespace vismap {

/// The text of the kind `timeline`: how far a log is mapped, its moments, and when objects came and
/// went. {"kind":"timeline","total":..,"read":..,"mapped":..,"done":..,"message":..,"stride":..,
/// "frames":[..],"utimes":[..],"marks":[{"frames":..,"utime":..,"id":..,"name":..,"appeared":..}]}
/// `frames` and `utimes` are of the moments, ascending; of the utimes the first is whole and each
/// other one the difference from the one before [us].
std::string TimelineText(const LogRecording& recording);

}  // namespace vismap
