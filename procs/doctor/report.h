#pragma once

#include <string>
#include <vector>

#include "doctor/findings.h"

namespace vismap {

/// The report as text for people: connection, processes, channels and findings.
std::string TextReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings);

/// The report as JSON for programs.
std::string JsonReport(const Listening& listening, const BusPicture& picture,
                       const std::vector<Finding>& findings);

}  // namespace vismap
