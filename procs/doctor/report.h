#pragma once

#include <string>
#include <vector>

#include "doctor/findings.h"

namespace vismap {

/// Self-check, processes, channels and findings for people.
std::string TextReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings);

/// The same for programs, as JSON.
std::string JsonReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings);

}  // namespace vismap
